"""One recording that is longer than memory, from a pipe to a ranking of one.

In: a spec and a binary stream of CSV. Out: the `Ranking` that `score` gives for a file of the same text, in memory
that depends on the spec alone.
"""

from types import MappingProxyType
from typing import BinaryIO

import numpy as np

from stlspec.binding import columns_of, missing_signal, used_signals
from stlspec.compiler.bundle import BundleData
from stlspec.errors import DataError
from stlspec.readers.model import Array, Recording
from stlspec.readers.stream import Block, CsvStream
from stlspec.sampling import OnNan, check_on_nan, settled
from stlspec.scores import Ranking, ranked, score_outcomes
from stlspec.semantics.streaming import Stream

NAME = "<stdin>"


def score_stream(
    bundle: BundleData, stream: BinaryIO, *, end: str = "clip", on_nan: OnNan = "refuse", name: str = NAME
) -> Ranking:
    """Score one recording as it comes.

    Paper: Algorithm 1, lines 4 to 7, for one demonstration.

    Args:    bundle: the compiled spec. stream: CSV as a file holds it, one recording. end: "clip" or "strict".
             on_nan: "refuse", "hold" or "drop". name: of the demonstration.
    Returns: a ranking of one, without its trace.
    Raises:  UsageError D896: a requirement needs every sample at once. DataError: the samples cannot be used.
    """
    check_on_nan(on_nan)
    outcomes = Stream(bundle, name)
    keys = {signal.name: signal.source or signal.name for signal in used_signals(bundle)}
    source = CsvStream(stream, name)
    recording = Recording(columns={n: np.empty(0) for n in source.names if n not in ("time", "episode", "action")})
    missing = [s for s in used_signals(bundle) if keys[s.name] not in recording.columns]
    if missing:
        raise DataError([missing_signal(s, recording, (), name) for s in missing])
    holes = _Holes(columns_of(bundle), on_nan, name)
    for block in source.blocks(columns_of(bundle)):
        for part in holes.filled(block):
            outcomes.take({s: part.columns[key] for s, key in keys.items()}, part.time, part.n_samples)
    found = outcomes.finish(end)
    return ranked(bundle, [score_outcomes(bundle, name, found)])


class _Holes:
    """Treats NaN as `sampling.settled` does, block after block; last: the newest values, for a hole to hold."""

    def __init__(self, keys: frozenset[str], on_nan: OnNan, name: str) -> None:
        self._keys, self._on_nan, self._name = keys, on_nan, name
        self._last: dict[str, Array] = {}

    def filled(self, block: Block) -> list[Block]:
        """Return the block with its holes treated; none if no sample is left of it."""
        if self._on_nan == "refuse":
            return [block]
        columns = {n: np.concatenate([self._last.get(n, c[:0]), c]) for n, c in block.columns.items()}
        before = len(next(iter(columns.values()), ())) - block.n_samples if columns else 0
        if self._on_nan == "hold":
            columns = dict(settled(Recording(columns=columns), self._keys, "hold", self._name).columns)
            self._last = {n: c[-1:].copy() for n, c in columns.items()}
            return [Block(block.time, {n: c[before:] for n, c in columns.items()}, block.n_samples)]
        try:
            left = settled(Recording(time=block.time, columns=columns), self._keys, "drop", self._name)
        except DataError:  # D803: nothing is left of this block
            return []
        return [Block(left.time, MappingProxyType(dict(left.columns)), left.n_samples or block.n_samples)]
