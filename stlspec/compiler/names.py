"""What a text declares: one table a kind of name, and the statements that may stand only once.

In: syntax. Out: `Declared` and a diagnostic for each name declared twice or statement out of place. Signals,
params, lets and requirements share one space of names, since formulas and `depends on` would confuse them.
"""

from collections.abc import Sequence

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.model import Declared
from stlspec.compiler.printing import number_text
from stlspec.errors import Diagnostic, Label, diagnostic
from stlspec.lang.nodes import (
    LetStatement,
    ParamStatement,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    Statement,
    TimeStatement,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.statements import TIME_UNITS
from stlspec.lang.units import NANOSECONDS, STEP
from stlspec.source import Span

_HERTZ = {"Hz": 1, "kHz": 1e3, "MHz": 1e6}


def declare(syntax: Syntax, problems: list[Diagnostic]) -> Declared:
    """Collect what `syntax` and the files it uses declare; what is wrong with it is added to `problems`."""
    tables: dict[type, dict[str, object]] = {
        kind: {} for kind in (SignalStatement, ParamStatement, LetStatement, RequirementStatement)
    }
    places: dict[str, Span] = {}
    files: dict[str, Syntax] = {}
    elsewhere: dict[str, Label] = {}
    for file in (*syntax.used, syntax):
        for statement in file.statements:
            if not isinstance(statement, SignalStatement | ParamStatement | LetStatement | RequirementStatement):
                continue
            name = statement.name
            if isinstance(statement, RequirementStatement) and file is not syntax:
                elsewhere[name.text] = Label(name.span, "stated here", file.source)
                continue
            if name.text in places:
                first = Label(places[name.text], "first declared here", files[name.text].source)
                problems.append(diagnostic("N102", source=file.source, span=name.span, labels=(first,), name=name.text))
                continue
            places[name.text], files[name.text] = name.span, file
            tables[type(statement)][name.text] = statement
    spec = _header(syntax, problems)
    time = _agreed(syntax, _time(syntax, problems), problems)
    return Declared(
        spec_name=spec.name.text if spec else "",
        title=spec.title.text if spec and spec.title else None,
        time=time or TimeBase("step", STEP, 1),
        signals=tables[SignalStatement],  # type: ignore[arg-type]
        params=tables[ParamStatement],  # type: ignore[arg-type]
        lets=tables[LetStatement],  # type: ignore[arg-type]
        requirements=tables[RequirementStatement],  # type: ignore[arg-type]
        places=places,
        files=files,
        elsewhere=elsewhere,
        time_known=time is not None,
    )


def _header(syntax: Syntax, problems: list[Diagnostic]) -> SpecStatement | None:
    found = [s for s in syntax.statements if isinstance(s, SpecStatement)]
    for i, statement in enumerate(syntax.statements):
        if isinstance(statement, SpecStatement) and i:
            if statement is not found[0]:
                problems.append(_misplaced(syntax, statement, "spec", "is given twice", "keep one of the two"))
            else:
                after, way = "stands after other statements", "move it to the top of the file"
                problems.append(_misplaced(syntax, statement, "spec", after, way))
    return found[0] if found else None


def _misplaced(
    syntax: Syntax, statement: SpecStatement | TimeStatement, word: str, problem: str, way: str
) -> Diagnostic:
    return diagnostic("S014", source=syntax.source, span=statement.span, word=word, problem=problem, help=way)


def _time(syntax: Syntax, problems: list[Diagnostic]) -> TimeBase | None:
    """Return the time base; None if the statement that gives it is broken."""
    found = [s for s in syntax.statements if isinstance(s, TimeStatement)]
    problems += [_misplaced(syntax, s, "time", "is given twice", "keep one of the two") for s in found[1:]]
    if not found:
        return None if syntax.lost.time else TimeBase("step", STEP, 1)
    return _time_base(syntax, found[0], problems)


def _agreed(syntax: Syntax, time: TimeBase | None, problems: list[Diagnostic]) -> TimeBase | None:
    """Return the time base if no used file measures time in another way: its bounds would mean something else."""
    before = len(problems)
    own = [Label(s.span, "the time of this file", syntax.source) for s in syntax.statements if _is_time(s)]
    for statement, direct in syntax.uses:
        for file in (*direct.used, direct):
            theirs = [s for s in file.statements if _is_time(s)]
            other = _time(file, problems) if theirs else None
            if other is None or time is None or other == time:
                continue
            there = Label(theirs[0].span, "another time there", file.source)
            written = file.source.slice(theirs[0].span)
            span, labels = statement.span, (there, *own[:1])
            problems.append(diagnostic("U307", source=syntax.source, span=span, labels=labels, time=written))
            break
    return time if len(problems) == before else None


def _as_period(number: float | None, unit: str) -> str:
    """Say which period a rate is, as sensors are described."""
    rate = (number or 0) * _HERTZ.get(unit, 0)
    if not 0 < rate <= NANOSECONDS["s"]:
        return ""
    name = next(name for name in ("s", "ms", "us", "ns") if NANOSECONDS["s"] / rate >= NANOSECONDS[name])
    period = NANOSECONDS["s"] / rate / NANOSECONDS[name]
    return f"; a rate of {number_text(number or 0)} {unit} is `time {period:.9g} {name}`"


def _is_time(statement: Statement) -> bool:
    return isinstance(statement, TimeStatement)


def _time_base(syntax: Syntax, statement: TimeStatement, problems: list[Diagnostic]) -> TimeBase | None:
    """Return the time base of a `time` statement; None if it is wrong, which is reported."""
    unit, number = statement.unit.text, statement.number
    if unit == STEP and number in (None, 1.0):
        return TimeBase("step", STEP, 1)
    if unit not in NANOSECONDS:
        allowed: Sequence[str] = (STEP, *TIME_UNITS) if number is None else TIME_UNITS
        units = ", ".join(allowed) + _as_period(number, unit)
        problems.append(diagnostic("U305", source=syntax.source, span=statement.unit.span, unit=unit, units=units))
        return None
    ticks = NANOSECONDS[unit]
    if number is None:
        return TimeBase("stamps", unit, ticks)
    period = round(number * ticks) if number * ticks < 2**62 else 0
    if period < 1:
        problems.append(diagnostic("I406", source=syntax.source, span=statement.span))
        return None
    return TimeBase("period", unit, ticks, period)
