"""The command monitor: samples in on stdin, a verdict out for each before the next one is read.

In: a spec, and one sample a line, CSV or JSON. Out: one line for each verdict, flushed at once, so that the
command can stand in a pipe. A line that cannot be used ends it with a diagnostic that names the line.
"""

import csv
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from stlspec.cli.options import FormatOption, Params, read_params, standard_input
from stlspec.cli.output import Format, error_document, warn
from stlspec.compiler.printing import number_text, short_text
from stlspec.errors import DataError, StlspecError, diagnostic

if TYPE_CHECKING:
    from stlspec.compiler.bundle import BundleData
    from stlspec.semantics.online import Known, Monitor, Standing

_LONGEST_LINE = 2**20
_STDIN = "<stdin>"


class Reading(StrEnum):
    """Which samples the verdicts are about."""

    START = "start"
    EVERY = "every"


class Ends(StrEnum):
    """What is promised of the end of the trace."""

    ANY = "any"
    HORIZON = "horizon"


Row = tuple[int, Mapping[str, Any]]
"""A line number and the values of its sample by column."""


def monitor(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="a spec file or a compiled bundle")],
    reading: Annotated[
        Reading, typer.Option("--reading", help="start: verdicts at sample 0; every: at each sample, once known")
    ] = Reading.START,
    ends: Annotated[
        Ends, typer.Option("--ends", help="any: the trace may end after any sample; horizon: it reaches the horizon")
    ] = Ends.ANY,
    params: Params = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Monitor samples from stdin (CSV with a header, or one JSON object a line), one line out for each verdict."""
    try:
        _follow(spec, reading, ends, read_params(params), output)
    except BrokenPipeError:
        # The reader has gone, which is no error here; what remains in the buffer must not raise again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except StlspecError as error:
        if output is not Format.JSON:
            raise
        _print(json.dumps(_error_line(error), ensure_ascii=False, allow_nan=False))
        raise typer.Exit(error.exit_code) from None


def _follow(spec: Path, reading: Reading, ends: Ends, params: dict[str, str], output: Format) -> None:
    from stlspec.compiler import files
    from stlspec.semantics.online import late_warnings, make_monitor

    bundle = files.read_spec(spec, params)
    monitor = make_monitor(bundle, reading.value, ends.value)
    if reading is Reading.EVERY:
        warn(late_warnings(bundle))
    json_wanted = output is Format.JSON
    columns, stream = _columns(bundle), standard_input()
    for line, values in _samples(iter(lambda: stream.readline(_LONGEST_LINE + 1), b"")):
        sample = {name: values[column] for name, column in columns.items() if column in values}
        try:
            told = monitor.update(sample, values.get("time"))
        except DataError as error:
            raise _placed(error, line) from None
        if reading is Reading.START:
            _print(_standing_line(monitor, told, json_wanted))
        else:
            _print(*(_known_line(known, json_wanted) for known in told))
    rest = monitor.finish()
    if reading is Reading.START:
        _print(_final_line(monitor, rest, json_wanted))
    else:
        _print(*(_known_line(known, json_wanted) for known in rest))


def _columns(bundle: "BundleData") -> dict[str, str]:
    """Return the column that each signal in use is read from."""
    used = {node.value for node in bundle.nodes if node.op in ("signal", "bool")}
    return {s.name: s.source or s.name for s in bundle.signals if s.name in used}


def _print(*lines: str) -> None:
    for line in lines:
        sys.stdout.write(line + "\n")
    sys.stdout.flush()


def _samples(lines: Iterator[bytes]) -> Iterator[Row]:
    """Read samples line by line; the first character that is not blank tells the format."""
    take: Callable[[int, str], Mapping[str, Any] | None] | None = None
    for number, raw in enumerate(lines, 1):
        text = _text(number, raw)
        if not text.strip():
            continue
        if take is None:
            take = _json_sample if text.lstrip().startswith("{") else _CsvRows()
        values = take(number, text)
        if values is not None:
            yield number, values


def _text(number: int, raw: bytes) -> str:
    if len(raw) > _LONGEST_LINE:
        _refuse(number, f"it is longer than {_LONGEST_LINE} bytes", "write one sample a line")
    try:
        return raw.decode("utf-8-sig" if number == 1 else "utf-8")
    except UnicodeDecodeError:
        _refuse(number, "it is not UTF-8 text", "write text: CSV with a header, or one JSON object a line")


class _CsvRows:
    """Reads the rows of a CSV stream; the first one holds the names."""

    def __init__(self) -> None:
        self._names: list[str] | None = None

    def __call__(self, number: int, text: str) -> Mapping[str, Any] | None:
        from stlspec.readers.model import number_of_word, repeated

        try:
            row = next(csv.reader([text], strict=True))
        except csv.Error as error:
            _refuse(number, f"it is not CSV ({error})", "write one row a line, without line ends inside quotes")
        if self._names is None:
            names = [name.strip() for name in row]
            twice = repeated(names)
            if twice is not None:
                _refuse(number, f"the header has the column '{twice[:60]}' twice", "give each column its own name")
            if all(isinstance(number_of_word(name), float) for name in names):
                _refuse(number, "it holds numbers, but must name the columns", "begin with a header such as time,x,y")
            self._names = names
            return None
        if len(row) != len(self._names):
            reason = f"it has {len(row)} values, but the header has {len(self._names)} columns"
            _refuse(number, reason, "give every column a value")
        pairs = zip(self._names, row, strict=True)
        return {name: _whole(word) if name == "time" else number_of_word(word) for name, word in pairs}


def _whole(word: str) -> Any:
    """Read a time stamp; a whole one stays whole, since nanoseconds since 1970 are no exact floats."""
    from stlspec.readers.model import number_of_word

    text = word.strip()
    return int(text) if text.lstrip("+-").isdecimal() and len(text) < 20 else number_of_word(word)


def _json_sample(number: int, text: str) -> Mapping[str, Any]:
    hint = 'write one object a line, such as {"x": 1, "time": 0.1}'
    try:
        values = json.loads(text)
    except (ValueError, RecursionError):
        _refuse(number, "it is not a JSON object", hint)
    if not isinstance(values, dict):
        _refuse(number, "it is not a JSON object", hint)
    return {name: float(v) if v in ("inf", "-inf") else v for name, v in values.items()}


def _refuse(line: int, reason: str, hint: str) -> NoReturn:
    raise _placed(DataError([diagnostic("D890", line=line, reason=reason, help=hint)]), line)


def _placed(error: DataError, line: int) -> DataError:
    return DataError([replace(d, file=f"{_STDIN}:{line}") for d in error.diagnostics])


def _error_line(error: StlspecError) -> dict[str, Any]:
    """Return the document of a failure; the line of the input has its own field."""
    document = error_document(error.exit_code, error.diagnostics)
    for entry in document["diagnostics"]:
        file, colon, line = str(entry["file"]).partition(":")
        if file == _STDIN and colon:
            entry |= {"file": file, "line": int(line)}
    return document


def _json_line(document: Mapping[str, Any]) -> str:
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def _number(value: float) -> float | str:
    """Return a number as the contract has it: finite, or a text."""
    return value if abs(value) != float("inf") else number_text(value)


def _standing_line(monitor: "Monitor", told: Mapping[str, "Standing"], as_json: bool) -> str:
    sample = monitor.n_samples - 1
    if as_json:
        rows = {
            name: {**{key: _number(getattr(s, key)) for key in ("low", "high", "current")}, "verdict": s.verdict}
            for name, s in told.items()
        }
        return _json_line({"sample": sample, "time": _number(monitor.time), "requirements": rows})
    parts = [
        f"{name} {s.verdict} [{short_text(s.low)}, {short_text(s.high)}] now {short_text(s.current)}"
        for name, s in told.items()
    ]
    return _text_line(sample, monitor.time, parts)


def _known_line(known: "Known", as_json: bool) -> str:
    if as_json:
        return _json_line(known._asdict() | {"robustness": _number(known.robustness), "time": _number(known.time)})
    text = f"{known.requirement} {known.verdict} {short_text(known.robustness)}"
    return _text_line(known.sample, known.time, [text])


def _final_line(monitor: "Monitor", rest: Mapping[str, Any], as_json: bool) -> str:
    if as_json:
        rows = {name: {"robustness": _number(f.robustness), "verdict": f.verdict} for name, f in rest.items()}
        head = {"final": True, "sample": monitor.n_samples - 1, "time": _number(monitor.time)}
        return _json_line({**head, "requirements": rows})
    parts = [f"{name} {f.verdict} {short_text(f.robustness)}" for name, f in rest.items()]
    return "final: " + "; ".join(parts)


def _text_line(sample: int, time: float, parts: Sequence[str]) -> str:
    shown = str(time) if isinstance(time, int) else number_text(time)
    at = f"{sample}" if time == sample else f"{sample} at {shown}"
    return f"{at}: " + "; ".join(parts)
