"""One sample as it comes in: its values and its time, checked as a recorded trace is.

In: what the caller gave. Out: floats, Booleans, ticks, or the same diagnostics that a trace gets at load. Nothing
here changes the state of a monitor, so that a refused sample leaves no trace.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NoReturn

import numpy as np

from stlspec.columns import snapped
from stlspec.compiler.bundle import Signal, TimeBase
from stlspec.compiler.notation import off_period
from stlspec.compiler.printing import number_text
from stlspec.errors import DataError, diagnostic
from stlspec.lang.spelling import closest_column
from stlspec.semantics.layout import own_time
from stlspec.semantics.online.saving import LARGEST, Remembering, State, Unsound, number, numbers, optional, whole

_LONGEST_TICKS = 2.0**62
_PERIOD_TOLERANCE = 0.01 * (1 + 1e-9)


def refuse(code: str, **fields: Any) -> NoReturn:
    """Raise the error that refuses a sample."""
    raise DataError([diagnostic(code, **fields)])


def _stamp(value: Any) -> float:
    """Read a kept time stamp; a whole one stays whole, since nanoseconds since 1970 are no exact floats."""
    return whole(value) if isinstance(value, int) else number(value)


class Clock(Remembering):
    """How many samples there were, and when.

    n: number of samples. ticks: time of the newest one since the first. first, stamp: time stamps of the first
    and the newest one as given; None without time stamps. last: low, high and current value of one requirement
    after the other, with the reading `start`; told: what was made of them. stamped: whether the next sample may
    have a time stamp, which is asked until a second one has none; it is found anew after loading.
    """

    __slots__ = ("_base", "_gapless", "first", "last", "n", "stamp", "stamped", "ticks", "told")
    STATE: ClassVar[State] = {
        "n": whole,
        "ticks": whole,
        "first": optional(_stamp),
        "stamp": optional(_stamp),
        "last": numbers,
    }

    def __init__(self, base: TimeBase, gapless: bool) -> None:
        self._base, self._gapless = base, gapless
        self.n, self.ticks = 0, -1
        self.first: float | None = None
        self.stamp: float | None = None
        self.stamped = True
        # A list once it is loaded, and so unlike any tuple: `told` is not saved.
        self.last: Sequence[float] = ()
        self.told: tuple[Any, ...] = ()

    def stamp_of(self, sample: Any, time: Any, declared: frozenset[str]) -> Any:
        """Return the time stamp of the next sample, its own under the key 'time' or `time`; None if it has none."""
        stamp = own_time(declared, sample, time)
        self.stamped = stamp is not None or self.n == 0 or self.stamp is not None
        return stamp

    def read(self, time: Any) -> int:
        """Return the ticks of the next sample. Raises: DataError: there cannot be one at `time`."""
        base = self._base
        if time is None:
            if base.kind == "stamps":
                refuse("D810", unit=base.unit)
            if self.first is not None:
                refuse("D891", sample=self.n, problem="has no time stamp, but those before it have")
            return self.n * (base.period or 1)
        stamp = self.number(time)
        if self.n and self.first is None:
            refuse("D891", sample=self.n, problem="has a time stamp, but those before it have none")
        ticks = (stamp - (stamp if self.first is None else self.first)) * base.ticks_per_unit
        if not math.isfinite(stamp) or not abs(ticks) < _LONGEST_TICKS:
            refuse("D812", time=number_text(stamp), sample=self.n)
        if base.kind == "stamps":
            if self.n and round(ticks) <= self.ticks:
                self._backwards(stamp)
            return round(ticks)
        if self.stamp is not None and stamp <= self.stamp:
            self._backwards(stamp)
        return self.n if base.kind == "step" else self._on_period(stamp, ticks)

    def number(self, time: Any) -> float:
        """Return a time stamp; a whole one stays whole, a float may still be infinite or NaN."""
        if isinstance(time, (int, np.integer)) and not isinstance(time, bool) and abs(int(time)) < LARGEST:
            return int(time)
        return as_real("time", time, self.n)

    def take(self, ticks: int, time: Any) -> None:
        """Count the sample whose time `read` has accepted."""
        if time is not None:
            self.stamp = self.number(time)
            if self.n == 0:
                self.first = self.stamp
        self.ticks = ticks
        self.n += 1

    def shown(self, ticks: int) -> float:
        """Return a time in the spec's unit, as offline results show it without time stamps."""
        return ticks / self._base.ticks_per_unit

    @property
    def latest(self) -> float:
        """Time of the newest sample in the spec's unit, as offline results show it."""
        return self.shown(self.ticks) if self.stamp is None or self._base.kind == "step" else self.stamp

    @property
    def begin(self) -> float:
        """Time of the first sample in the spec's unit, as offline results show it."""
        return 0.0 if self.first is None or self._base.kind == "step" else self.first

    def ends(self) -> list[tuple[float, float, float]]:
        """Return low, high and current value of each requirement."""
        return list(zip(self.last[0::3], self.last[1::3], self.last[2::3], strict=True))

    def check(self, n: int, newest: int) -> None:
        """Check what values together must obey."""
        super().check(n, newest)
        if self.n < 0 or (self.ticks < 0) != (self.n == 0) or len(self.last) % 3:
            raise Unsound("the clock is wrong")

    def now(self, time: Any) -> str:
        """Name the time of the next sample in a message."""
        if time is None or self._base.kind == "step":
            return number_text(self.n * (self._base.period or 1) / self._base.ticks_per_unit)
        return number_text(self.number(time))

    def _backwards(self, stamp: float) -> NoReturn:
        assert self.stamp is not None
        refuse("D802", sample=self.n, time=number_text(stamp), previous=number_text(self.stamp))

    def _on_period(self, stamp: float, ticks: float) -> int:
        base, period = self._base, self._base.period or 1
        periods = ticks / period
        count = round(periods)
        last = self.ticks // period
        if abs(periods - count) > _PERIOD_TOLERANCE or (self.n and count <= last):
            length = f"{number_text(period / base.ticks_per_unit)} {base.unit}"
            way = off_period(base, stamp - self.stamp if self.stamp is not None else stamp)
            refuse("D811", sample=self.n, time=number_text(stamp), period=length, unit=base.unit, help=way)
        if self._gapless and self.n and count > last + 1:
            refuse("D892", sample=self.n, time=number_text(stamp), periods=count - last)
        return count * period


def as_real(name: str, value: Any, sample: int) -> float:
    """Return the value of a real signal. Raises: DataError D806: it is no number."""
    try:
        if isinstance(value, (str, bytes, complex)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        _bad(name, "real", value, sample)


def as_boolean(name: str, value: Any, sample: int, time: str) -> bool:
    """Return the value of a Boolean signal. Raises: DataError D801, D806."""
    if value is True or value is False:
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    read = value if isinstance(value, (str, bytes, complex)) else None
    if read is None:
        try:
            read = float(value)
        except (TypeError, ValueError, OverflowError):
            read = None
    if isinstance(read, float) and math.isnan(read):
        refuse("D801", signal=name, sample=sample, time=time)
    if read not in (0.0, 1.0):
        _bad(name, "bool", value, sample)
    return read == 1.0


def _bad(name: str, kind: str, value: Any, sample: int) -> NoReturn:
    shown = number_text(float(value)) if isinstance(value, (float, np.floating)) else repr(value)
    shown = shown if len(shown) <= 30 else shown[:29] + "…"
    hint = "write true, false, 1 or 0" if kind == "bool" else "write a number, inf or -inf"
    refuse("D806", signal=name, value=shown, sample=sample, type=kind, help=hint)


def outside(signal: Signal, value: float, sample: int, time: str) -> float:
    """Refuse a value that is NaN or outside its declared range; return the bound that it is in 32 bits."""
    if math.isnan(value):
        refuse("D801", signal=signal.name, sample=sample, time=time)
    edge = np.array([value])
    snapped(edge, *(side if b is None else b for side, b in ((-math.inf, signal.low), (math.inf, signal.high))))
    if edge[0] != value:
        return float(edge[0])
    low = number_text(-math.inf if signal.low is None else signal.low)
    high = number_text(math.inf if signal.high is None else signal.high)
    return refuse("D807", signal=signal.name, value=number_text(value), low=low, high=high, sample=sample, time=time)


def missing(names: Mapping[str, Any] | Any, wanted: list[str]) -> NoReturn:
    """Refuse a sample without a value of one of the wanted signals, or one that is no mapping."""
    if not isinstance(names, Mapping):
        refuse("D813", what="a sample", problem=f"is a {type(names).__name__}, not a mapping from names to values")
    name = next((w for w in wanted if w not in names), wanted[0])
    close = closest_column(name, [str(n) for n in names])
    known = ", ".join(f"'{n}'" for n in list(names)[:5])
    hint = f"did you mean '{close}'?" if close else f"the sample has {known or 'no signals'}"
    refuse("D804", signal=name, help=hint)
