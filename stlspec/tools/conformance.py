"""Conformance vectors: small cases that any implementation of the logic can run.

In: a JSON file of vectors, each a formula as nested lists, a trace, a sample, the value and the verdict that
the definition gives there. Out: for each vector what this implementation makes of it. The formula is written
out as text and compiled like any other, so that a vector tests the whole way from text to value. What is no
vector is refused with the file; what is one, but cannot be compiled or evaluated, is a result.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stlspec import api
from stlspec.compiler.ir import COMPARISONS
from stlspec.compiler.printing import number_text
from stlspec.errors import DataError, StlspecError
from stlspec.readers.document import decode
from stlspec.readers.model import read_bytes, refusal

SCHEMA = "stlspec.conformance/1"
LARGEST = 2**24
DEEPEST = 200

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,99}")
_WORDS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}
_PREFIX = {"not": "not", "next": "next", "prev": "prev"}
_INFIX = {"and": "and", "or": "or", "implies": "implies", "iff": "iff", "xor": "xor"}
_TIMED = {"G": "always", "F": "eventually", "H": "historically", "O": "once"}
_TIMED_PAIR = {"U": "until", "S": "since", "R": "release", "W": "unless"}
_ERRORS = {"error:interval": "I4", "error:nan": "D801"}
"""What an expected error is called in a vector, and how the codes that stand for it begin."""
_TOLERANCE = 1e-9


class _NoVectorError(ValueError):
    """Something in a vector that cannot be read; says what."""


@dataclass(frozen=True, slots=True)
class Vector:
    """One case.

    text: the formula in the language. signals: the values of each at every sample. times: stamps, in the unit
    of the bounds. at: the sample whose value is wanted. expected: the robustness there, or a key of `_ERRORS`.
    verdict: "satisfied" or "violated"; None where an error is expected, or the verdict does not matter.
    """

    id: str
    text: str
    signals: Mapping[str, tuple[float | bool, ...]]
    booleans: frozenset[str]
    times: tuple[float, ...]
    at: int
    expected: float | str
    verdict: str | None = None

    def spec(self) -> str:
        """Return a spec whose one requirement is the formula; time stamps are seconds."""
        kinds = (f"signal {name}{': bool' if name in self.booleans else ''}\n" for name in self.signals)
        return f"time s\n{''.join(kinds)}hard vector: {self.text}\n"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a vector: a robustness with its verdict, or an error with its codes."""

    vector: Vector
    robustness: float | None = None
    verdict: str | None = None
    codes: tuple[str, ...] = ()
    message: str = ""

    @property
    def holds(self) -> bool:
        """Whether this is what the vector expects."""
        expected = self.vector.expected
        if isinstance(expected, str):
            return bool(self.codes) and all(code.startswith(_ERRORS[expected]) for code in self.codes)
        if self.robustness is None:
            return False
        same = math.isclose(self.robustness, expected, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE)
        return same and self.vector.verdict in (None, self.verdict)


def load_vectors(path: str | Path) -> tuple[Vector, ...]:
    """Read a file of vectors.

    Not in the paper: other tools can be held against the same cases.

    Raises: DataError: it cannot be read, is larger than `LARGEST`, is no JSON, or holds something else.
    """
    file = Path(path)
    try:
        text = read_bytes(file, "conformance vectors", LARGEST).decode("utf-8")
    except UnicodeDecodeError as error:
        what = f"this is not UTF-8 text: byte {error.start} is 0x{error.object[error.start]:02x}"
        raise _refused(file, what) from None
    document = decode(text, file)
    listed = document.get("vectors") if isinstance(document, dict) else None
    schema = document.get("meta") if isinstance(document, dict) else None
    found = schema.get("schema") if isinstance(schema, dict) else None
    if found != SCHEMA or not isinstance(listed, list) or not listed:
        raise _refused(file, "this is no file of conformance vectors")
    vectors = []
    for index, item in enumerate(listed):
        try:
            vectors.append(_vector(item))
        except _NoVectorError as error:
            name = item.get("id") if isinstance(item, dict) else None
            shown = f" (id {_shown(name)})" if isinstance(name, str) else ""
            raise _refused(file, f"vector {index}{shown}: {error}") from None
    return tuple(vectors)


def run_vector(vector: Vector) -> Outcome:
    """Compile the formula of a vector and evaluate it on its trace.

    Not in the paper: it tests the compiler as a whole.

    Returns: the outcome; an error of the formula or the trace is one too.
    """
    try:
        bundle = api.compile(vector.spec())
        result = bundle.evaluate(vector.signals, vector.times, at=vector.at)["vector"]
    except StlspecError as error:
        errors = [d for d in error.diagnostics if d.severity == "error"]
        return Outcome(vector, codes=tuple(d.code for d in errors), message=errors[0].message if errors else "")
    return Outcome(vector, result.robustness, result.verdict.value)


def formula_text(formula: Any) -> str:
    """Write a formula of a vector in the language, every operand in parentheses, bounds in seconds.

    Not in the paper: a file format.

    Args:   formula: nested lists, [operator, operands...]: see tests/conformance/README.md.
    Raises: ValueError: it is no formula.
    """
    return _text(formula, 0)


def _refused(file: Path, what: str) -> DataError:
    way = f'a vectors file is JSON, {{"meta": {{"schema": "{SCHEMA}"}}, "vectors": [...]}}'
    return refusal("D880", file, what=what, help=way)


def _vector(item: Any) -> Vector:
    if not isinstance(item, dict):
        raise _NoVectorError("it is no object")
    trace, at, verdict = item.get("trace"), item.get("at", 0), item.get("verdict")
    if not isinstance(trace, dict) or "t" not in trace:
        raise _NoVectorError("'trace' is no object with 't', the time stamps")
    if not isinstance(at, int) or isinstance(at, bool) or abs(at) > LARGEST:
        raise _NoVectorError(f"'at' is {_shown(at)}, which is no sample")
    if verdict not in (None, "satisfied", "violated"):
        raise _NoVectorError(f"'verdict' is {_shown(verdict)}, not satisfied or violated")
    formula = item.get("formula")
    text = formula_text(formula)
    signals = {_name(key): _column(key, values) for key, values in trace.items() if key != "t"}
    return Vector(
        id=str(item.get("id"))[:100],
        text=text,
        signals=MappingProxyType(signals),
        booleans=_booleans(formula),
        times=tuple(map(float, _column("t", trace["t"]))),
        at=at,
        expected=_expected(item.get("expected")),
        verdict=verdict,
    )


def _expected(value: Any) -> float | str:
    if isinstance(value, str) and value.startswith("error:"):
        if value not in _ERRORS:
            raise _NoVectorError(f"'expected' is {_shown(value)}, not one of {', '.join(_ERRORS)}")
        return value
    number = _number(value)
    if math.isnan(number):
        raise _NoVectorError("'expected' is not a number")
    return number


def _column(name: str, values: Any) -> tuple[float | bool, ...]:
    if not isinstance(values, list):
        raise _NoVectorError(f"'{name[:40]}' of the trace is no list")
    return tuple(value if isinstance(value, bool) else _number(value) for value in values)


def _number(value: Any) -> float:
    if isinstance(value, str) and value in _WORDS:
        return _WORDS[value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _NoVectorError(f"{_shown(value)} is no number, 'inf' or '-inf'")
    try:
        return float(value)
    except OverflowError:
        raise _NoVectorError("a number is too long") from None


def _name(value: Any) -> str:
    """Accept only names, since they become part of a text that is compiled."""
    if isinstance(value, str) and _NAME.fullmatch(value):
        return value
    raise _NoVectorError(f"{_shown(value)} is no name of a signal")


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:39] + "…"


def _text(formula: Any, depth: int) -> str:
    if depth > DEEPEST:
        raise _NoVectorError(f"the formula is nested deeper than {DEEPEST}")
    if not isinstance(formula, list) or not formula or not isinstance(formula[0], str):
        raise _NoVectorError(f"{_shown(formula)} is no formula")
    op, operands = formula[0], formula[1:]
    if op == "pred" and len(operands) == 3:
        return _predicate(*operands)
    if op == "bool" and len(operands) == 1:
        return _name(operands[0])
    if op in _PREFIX and len(operands) == 1:
        return f"{_PREFIX[op]} ({_text(operands[0], depth + 1)})"
    if op in _INFIX and len(operands) == 2:
        left, right = (_text(operand, depth + 1) for operand in operands)
        return f"({left}) {_INFIX[op]} ({right})"
    if op in _TIMED and len(operands) == 2:
        return f"{_TIMED[op]}{_interval(operands[0])} ({_text(operands[1], depth + 1)})"
    if op in _TIMED_PAIR and len(operands) == 3:
        left, right = (_text(operand, depth + 1) for operand in operands[1:])
        return f"({left}) {_TIMED_PAIR[op]}{_interval(operands[0])} ({right})"
    raise _NoVectorError(f"{_shown(op)} with {len(operands)} operands is no operator")


def _predicate(signal: Any, sign: Any, bound: Any) -> str:
    number = _number(bound)
    if sign not in COMPARISONS.values() or math.isnan(number):
        raise _NoVectorError(f"{_shown(['pred', signal, sign, bound])} is no comparison")
    return f"{_name(signal)} {sign} {number_text(number)}"


def _interval(bounds: Any) -> str:
    if bounds is None:
        return ""
    if not isinstance(bounds, list) or len(bounds) != 2:
        raise _NoVectorError(f"{_shown(bounds)} is no interval")
    low, high = (_number(bound) for bound in bounds)
    if math.isnan(low) or math.isnan(high):
        raise _NoVectorError("a bound is not a number")
    return f"[{_seconds(low)}, {_seconds(high)}]"


def _seconds(bound: float) -> str:
    return number_text(bound) if math.isinf(bound) else f"{number_text(bound)} s"


def _booleans(formula: Any) -> frozenset[str]:
    """Find the signals that are used as Booleans, in a formula that was written out before."""
    if formula[0] == "bool":
        return frozenset([formula[1]])
    return frozenset().union(*(_booleans(part) for part in formula[1:] if _is_formula(part)))


def _is_formula(part: Any) -> bool:
    return isinstance(part, list) and bool(part) and isinstance(part[0], str)
