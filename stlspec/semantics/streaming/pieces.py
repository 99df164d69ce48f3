"""The newest samples of a recording, as one trace whose beginning is cut off.

In: blocks of columns in the order in which they come. Out: `Trace`s whose times and numbers count from the first
sample of the recording, checked as a whole recording is: what is refused there is refused here, with the same words.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.columns import to_column, unmasked
from stlspec.compiler.bundle import BundleData
from stlspec.errors import DataError, diagnostic
from stlspec.traces import Trace, check_values, sample_ticks, ticks_array, whole_stamps


class Pieces:
    """Checks blocks and keeps the samples that are still looked at."""

    def __init__(self, bundle: BundleData, file: str | None) -> None:
        used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
        self.base, self.file = bundle.time, file
        self.declared = [s for s in bundle.signals if s.name in used]
        self.n = 0
        self.waiting = 0
        self._blocks: list[Trace] = []
        self._stamps: list[int | float] = []

    @property
    def kept(self) -> int:
        """How many samples are kept."""
        return sum(block.n_samples for block in self._blocks)

    def add(self, signals: Mapping[str, ArrayLike], time: ArrayLike | None, n: int) -> None:
        """Take the next n samples. Raises: DataError D801 to D813, as for a recording."""
        columns = {}
        for s in self.declared:
            columns[s.name] = to_column(s.name, signals[s.name], self.file, s.type, (), self.n)
        times, stamps = self._times(n, time)
        block = Trace(
            ticks=times,
            signals=MappingProxyType(columns),
            spacing=None,
            ticks_per_unit=self.base.ticks_per_unit,
            unit=self.base.unit,
            stamps=stamps,
            file=self.file,
            first=self.n,
        )
        check_values(block, self.declared)
        self._blocks.append(block)
        self.n += n
        self.waiting += n

    def _times(self, n: int, time: ArrayLike | None) -> tuple[NDArray[np.int64], NDArray[np.float64] | None]:
        """Return ticks since the first sample of all: the first and the newest stamp so far go before these."""
        if time is None:
            times, _ = sample_ticks(self.base, n, None, self.file)
            return ticks_array(times) + self.n * (self.base.period or 1), None
        before = self._stamps
        given = np.asarray(unmasked(time))
        whole = whole_stamps(given)
        stamps = given.astype(np.float64) if whole is None and given.dtype.kind in "biuf" else given
        stamps = stamps if whole is None else whole
        joined = np.concatenate([np.asarray(before, dtype=stamps.dtype), stamps]) if before else stamps
        ticks, shown = sample_ticks(self.base, len(joined), joined, self.file, self.n - len(before))
        self._stamps = [joined[0].item(), joined[-1].item()] if self.n + n > 1 else [joined[0].item()]
        if self.base.kind == "step":
            return np.arange(self.n, self.n + n, dtype=np.int64), None
        return ticks_array(ticks)[len(before) :], None if shown is None else shown[len(before) :]

    def joined(self) -> Trace:
        """Return all samples that are kept as one trace."""
        blocks, first = self._blocks, self._blocks[0]
        times = np.concatenate([b.times for b in blocks])
        stamps = [b.stamps for b in blocks if b.stamps is not None]
        names = first.signals
        whole = replace(
            first,
            ticks=times,
            signals=MappingProxyType({name: np.concatenate([b.signals[name] for b in blocks]) for name in names}),
            spacing=self._spacing(times),
            stamps=np.concatenate(stamps) if stamps else None,
        )
        self._blocks = [whole]
        self.waiting = 0
        return whole

    def _spacing(self, times: NDArray[np.int64]) -> int | None:
        """Return the ticks between samples if they are the same everywhere."""
        if len(times) == 1:
            return self.base.period or 1
        steps = np.diff(times)
        return int(steps[0]) if (steps == steps[0]).all() else None

    def drop(self, count: int) -> None:
        """Forget the first samples of `joined`."""
        (whole,) = self._blocks
        left = replace(
            whole,
            ticks=whole.times[count:].copy(),
            signals=MappingProxyType({name: values[count:].copy() for name, values in whole.signals.items()}),
            stamps=None if whole.stamps is None else whole.stamps[count:].copy(),
            first=whole.first + count,
        )
        self._blocks = [left]

    def check_begun(self) -> None:
        """Refuse a recording without samples. Raises: DataError D803."""
        if self.n == 0:
            raise DataError([diagnostic("D803", file=self.file, where=": the input has a header and no samples")])
