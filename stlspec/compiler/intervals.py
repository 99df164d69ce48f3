"""Bounds of temporal operators, from constants with units to whole ticks.

In: an interval, the typings of its bounds, the time base. Out: (low, high) in ticks, high None for no end, or a
diagnostic. Bounds are rounded to the nearest tick once, here; all window arithmetic after this is on integers.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.model import Typing
from stlspec.errors import Diagnostic, Edit, Fix, diagnostic
from stlspec.lang.nodes import Expression, Group, Infix, Interval, Number
from stlspec.lang.units import NANOSECONDS, STEP, spell
from stlspec.source import SourceText, Span

_LARGEST = 2**62
_NOISE = 1e-12
_COUNTED = 1e6
"""A plain bound above this is hardly a number of samples."""
Ticks = tuple[int, int | None]
Report = Callable[..., None]


def ticks_of(
    interval: Interval,
    bounds: tuple[Typing, Typing],
    time: TimeBase,
    source: SourceText,
    problems: list[Diagnostic],
) -> Ticks | None:
    """Return the interval in ticks; None if a param is not bound yet or something was reported."""
    before = len(problems)

    def report(code: str, span: Span, **fields: Any) -> None:
        problems.append(diagnostic(code, source=source, span=span, **fields))

    nodes = (interval.low, interval.high)
    if any(_lacks_unit(bound, time) for bound in bounds):
        _report_plain(interval, bounds, source, time, report)
    for node, bound in zip(nodes, bounds, strict=True):
        if bound.unit is not None:
            _check_unit(bound, node, time, report)
    if len(problems) > before or any(bound.value is None for bound in bounds):
        return None
    low, high = (_in_ticks(bound, time) for bound in bounds)
    texts = [source.slice(node.span) for node in (interval.low, interval.high)]
    spans = [interval.low.span, interval.high.span]
    _check_order(low, high, interval.span, texts, spans, report)
    if len(problems) > before:
        return None
    return _rounded(low, high, interval, texts, time, report)


def swapped(source: SourceText, interval: Interval) -> tuple[Edit, Edit]:
    """Return the edits that exchange the bounds of an interval. Not in the paper: it serves the messages."""
    low, high = interval.low.span, interval.high.span
    return Edit(low, source.slice(high)), Edit(high, source.slice(low))


def _in_ticks(bound: Typing, time: TimeBase) -> float:
    assert bound.value is not None
    word = next(iter(bound.unit)) if bound.unit else None
    return bound.value * (NANOSECONDS[word] if word in NANOSECONDS and time.kind != "step" else 1)


def _lacks_unit(bound: Typing, time: TimeBase) -> bool:
    """Tell whether a bound has no unit where the spec has one; 0 and infinity need none."""
    return bound.unit is None and time.kind != "step" and bound.value not in (None, 0, math.inf)


def _report_plain(
    interval: Interval, bounds: tuple[Typing, Typing], source: SourceText, time: TimeBase, report: Report
) -> None:
    """Report the bounds of one interval that lack their unit, both at once, and in their order if they are reversed."""
    nodes = (interval.low, interval.high)
    unit = _unit_meant(bounds, time)
    plain = [(node, bound) for node, bound in zip(nodes, bounds, strict=True) if _lacks_unit(bound, time)]
    span = plain[0][0].span if len(plain) == 1 else interval.span
    numbers = [number for node, _ in plain for number in _terms(node)]
    ends = [n.span.end for n in numbers if isinstance(n, Number) and n.unit is None]
    if len(ends) < len(numbers):
        way = f"give the numbers and params in it a unit, such as {unit}"
        report("U303", span, unit=time.unit, help=way)
        return
    texts = [_with_unit(source, node.span, ends, unit) for node in nodes]
    low, high = (_ticks_meant(bound, unit) for bound in bounds)
    if low is not None and high is not None and low > high:
        texts.reverse()
        span = interval.span
    edits = tuple(Edit(n.span, new) for n, new in zip(nodes, texts, strict=True) if new != source.slice(n.span))
    way = f"write `{_edited(source, span, edits)}`{_in_samples(plain, time)}"
    report("U303", span, unit=time.unit, edits=edits, help=way)


def _in_samples(plain: Sequence[tuple[Expression, Typing]], time: TimeBase) -> str:
    """Return how long as many samples are as the last plain bound says, for those who count samples."""
    node, bound = plain[-1]
    count = round(bound.value) if bound.value is not None and 0 < bound.value < _COUNTED else 0
    if time.period is None or not isinstance(node, Number) or not count or count != bound.value:
        return ""
    # `[0, 500]` at 100 ms is a time in ms without doubt.
    if time.period > time.ticks_per_unit and count * time.ticks_per_unit % time.period == 0:
        return ""
    return f"; {count} sample{'s are' if count > 1 else ' is'} `{_span_of(count, time)}`"


def _unit_meant(bounds: tuple[Typing, Typing], time: TimeBase) -> str:
    """Return the unit to propose: that of the other bound, else the first, from that of the spec on, that fits.

    It fits if the bounds are then whole numbers of periods: with `time 100 ms`, `[0, 5]` hardly means 5 ms.
    """
    written = [word for bound in bounds for word in bound.unit or () if word in NANOSECONDS]
    if written:
        return written[0]
    larger = [word for word, ticks in NANOSECONDS.items() if ticks >= time.ticks_per_unit]
    period = time.period
    return time.unit if period is None else next((u for u in larger if _fits(bounds, u, period)), time.unit)


def _fits(bounds: tuple[Typing, Typing], unit: str, period: int) -> bool:
    """Tell whether bounds in a unit are whole numbers of periods, as far as they are known and end."""
    ticks = [found for bound in bounds if (found := _ticks_meant(bound, unit)) is not None and math.isfinite(found)]
    return all(round(found) % period == 0 for found in ticks)


def _ticks_meant(bound: Typing, unit: str) -> float | None:
    """Return a bound in ticks, in `unit` where it has none; None if it is not known."""
    word = next(iter(bound.unit)) if bound.unit else unit
    return bound.value * NANOSECONDS[word] if bound.value is not None and word in NANOSECONDS else None


def _with_unit(source: SourceText, span: Span, ends: Sequence[int], unit: str) -> str:
    """Return the text of a bound with a unit behind each number that ends at one of `ends`."""
    return _edited(source, span, [Edit(Span(end, end), f" {unit}") for end in ends if span.start < end <= span.end])


def _edited(source: SourceText, span: Span, edits: Sequence[Edit]) -> str:
    """Return a stretch of the text with edits made that lie in it."""
    by = span.start
    return Fix("", tuple(Edit(Span(e.span.start - by, e.span.end - by), e.text) for e in edits)).applied(
        source.slice(span)
    )


def _terms(node: Expression) -> list[Expression]:
    """Return the terms of a sum that need a unit each."""
    if isinstance(node, Group):
        return _terms(node.inner)
    if isinstance(node, Infix) and node.operators[0].word in ("add", "sub"):
        return [term for operand in node.operands for term in _terms(operand)]
    return [node]


def _check_unit(bound: Typing, node: Expression, time: TimeBase, report: Report) -> None:
    """Refuse a bound in the wrong unit."""
    span = node.span
    assert bound.unit is not None
    shown = f"`{spell(bound.unit)}`" if bound.unit else "a plain number"
    word = next(iter(bound.unit)) if len(bound.unit) == 1 else ""
    if time.kind == "step" and bound.unit != {STEP: 1}:
        declare = f" or declare `time {word}`" if word in NANOSECONDS else ""
        report(
            "U304",
            span,
            unit=shown,
            problem="the spec counts samples (`time step`)",
            help=f"write a number of samples{declare}",
        )
    elif time.kind != "step" and (word not in NANOSECONDS or bound.unit[word] != 1):
        report(
            "U304",
            span,
            unit=shown,
            problem=f"the spec measures time in {time.unit}",
            help=f"write a time, such as `5 {time.unit}`",
        )


def _check_order(low: float, high: float, span: Span, texts: list[str], spans: list[Span], report: Report) -> None:
    for value, text, place in zip((low, high), texts, spans, strict=True):
        if value < 0:
            way = "to look back, use `historically`, `once` or `since` with bounds from 0"
            report("I402", place, value=text, help=way)
            return
        if _LARGEST < value < math.inf:
            report("I405", place, value=text)
            return
    if low == math.inf:
        report("I404", span, problem="it begins at infinity", help="write [0, inf]")
    elif low > high:
        edits = (Edit(spans[0], texts[1]), Edit(spans[1], texts[0]))
        report("I401", span, edits=edits, low=texts[0], high=texts[1])


def _rounded(low: float, high: float, interval: Interval, texts: list[str], time: TimeBase, report) -> Ticks | None:  # type: ignore[no-untyped-def]
    """Round to ticks; with a period, say which samples a bound between two of them covers."""
    if time.kind == "step":
        # A whole number of samples may come out of arithmetic with a fault in the last digits: 0.1 * 30.
        low, high = (
            round(x) if math.isfinite(x) and abs(x - round(x)) < _NOISE * max(1, x) else x for x in (low, high)
        )
        ticks = (math.ceil(low), None if high == math.inf else math.floor(high))
        exact = low == ticks[0] and (ticks[1] is None or high == ticks[1])
    else:
        ticks = (round(low), None if high == math.inf else round(high))
        exact = time.period is None or all(t is None or t % time.period == 0 for t in ticks)
    if exact:
        return ticks
    period = time.period or 1
    first = -(-ticks[0] // period)
    last = None if ticks[1] is None else ticks[1] // period
    if last is not None and first > last:
        report("I404", interval.span, problem="it lies between two samples", help="widen it to hold a sample")
        return None
    covers = (
        f"sample {first}"
        if first == last
        else f"samples {first} to {last}"
        if last is not None
        else f"samples from {first} on"
    )
    off = 0 if (low != ticks[0] or ticks[0] % period) else 1
    way = f"write {_written(first, last, time)} to say so"
    if first == last and low != high:
        # `[0, 5 ms]` at 50 ms hardly means one sample, so `[0, 0]` is no way out.
        spacing = f"the period is {_span_of(1, time)}" if time.period else "bounds count whole samples"
        way = f"{spacing}: a window of more than one sample reaches further, as in {_written(first, first + 1, time)}"
    report("I403", interval.span, value=texts[off], covers=covers, help=way)
    return ticks


def _written(first: int, last: int | None, time: TimeBase) -> str:
    if time.kind == "step":
        return f"[{first}, {'inf' if last is None else last}]"
    parts = []
    for sample in (first, last):
        if sample is None:
            parts.append("inf")
        else:
            parts.append(_span_of(sample, time) if sample else "0")
    return f"[{', '.join(parts)}]"


def _span_of(samples: int, time: TimeBase) -> str:
    """Return how long so many periods are, in the unit of the spec."""
    return f"{samples * (time.period or 1) / time.ticks_per_unit:g} {time.unit}"
