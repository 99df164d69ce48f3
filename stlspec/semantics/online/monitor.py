"""The online monitor: samples in, one at a time; what is known of each requirement out.

In: a compiled spec. Out: `Monitor`. Its memory can be copied, saved as bytes and restored, and none of it grows
with the number of samples unless a formula needs them all. A sample that is refused changes nothing.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.errors import Diagnostic, UsageError, diagnostic
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.arrays import Columns
from stlspec.semantics.online.every import Known, every_program
from stlspec.semantics.online.opening import Opening, deferred
from stlspec.semantics.online.plan import Ends, make_plan
from stlspec.semantics.online.program import Objects, Program, shown, start_program
from stlspec.semantics.online.samples import refuse
from stlspec.semantics.online.saving import Unsound
from stlspec.semantics.online.states import make_states
from stlspec.semantics.robustness import shown as shown_values

Reading = Literal["start", "every"]
Table = Mapping[str, ArrayLike] | ArrayLike
Floats = NDArray[np.float64]

_SCHEMA = "stlspec.monitor/1"
_LARGEST = 2**28


@dataclass(frozen=True, slots=True)
class Final:
    """What a requirement is worth at sample 0 if the trace ends here: just what an evaluation gives."""

    robustness: float
    verdict: Verdict


@dataclass(frozen=True, slots=True, eq=False)
class Open:
    """The samples at which a requirement is not known yet, with enclosures; ties are shown as 0.

    samples: int64, (n,), without a gap. times: in the spec's unit. low, high, current: (n,), as in `Standing`.
    """

    samples: NDArray[np.int64]
    times: Floats
    low: Floats
    high: Floats
    current: Floats


_UPDATE = """Take the next sample.

Not in the paper: it evaluates complete traces only. The step of Algorithm 2 that looks at a partial trace takes
`current`.

Args:    sample: a value for each signal that a requirement uses, and its time stamp under the key `time`, as in
         files, unless the spec declares a signal of that name; others are ignored. Whether stamps stand there, the
         first sample decides. The number of a state if the monitor was made for `states`.
         time: its time stamp in the spec's unit, where the sample has none; None where samples are counted or
         periodic.
Returns: with the reading `start` a mapping from requirements to `Standing`: what is known of their values at
         sample 0. With `every` a list of `Known`: the values that this sample made known, for each requirement in
         order of the samples.
Raises:  DataError: the sample cannot be used; the monitor is as it was before. UsageError: it has stamps in both
         places.
"""


class Update(Protocol):
    """What takes the next sample of a monitor."""

    def __call__(self, sample: Mapping[str, Any] | int, time: float | None = None) -> Any:
        """Take the next sample: see `Monitor.update`."""


class Monitor:
    """Follows one trace. Make one with `make_monitor`; use it from one thread at a time."""

    # `update` is the generated function itself: a method around it would take a tenth of its time.
    __slots__ = {"_bundle": None, "_objects": None, "_program": None, "update": _UPDATE}

    def __init__(self, bundle: BundleData, program: Program, objects: Objects) -> None:
        self._bundle, self._program, self._objects = bundle, program, objects
        self.update: Update = program.bind(objects)

    @property
    def reading(self) -> Reading:
        """What is followed: "start" or "every"."""
        return "start" if self._program.opening < 0 else "every"

    @property
    def ends(self) -> Ends:
        """What is promised of the end: "any" or "horizon"."""
        return self._program.ends

    @property
    def n_samples(self) -> int:
        """Number of samples so far."""
        return self._objects.clock.n

    @property
    def time(self) -> float:
        """Time of the newest sample in the spec's unit, as given if it was given."""
        return self._objects.clock.latest

    def pending(self) -> Mapping[str, Open]:
        """Return, for each requirement, enclosures at the samples at which it is not known yet.

        With the reading `start` that is sample 0, as long as its enclosure is not a single value. Not in the
        paper: it evaluates complete traces only.
        """
        names = [r.name for r in self._bundle.requirements]
        n = self.n_samples
        if n == 0:
            return {name: _open(np.arange(0), np.empty(0), _columns(np.empty((0, 3)))) for name in names}
        if self.reading == "start":
            clock = self._objects.clock
            rows = [np.array([row] if row[0] != row[1] else np.empty((0, 3))) for row in clock.ends()]
            begin = np.array([clock.begin])
            found = [(np.arange(len(row)), begin[: len(row)], _columns(shown_values(row))) for row in rows]
            return {name: _open(*columns) for name, columns in zip(names, found, strict=True)}
        opening = self._opening()
        return {
            name: _open(*opening.positions(first, n), columns)
            for name, (first, columns) in zip(names, opening.shown_samples(n), strict=True)
        }

    def finish(self) -> Any:
        """Return what is worth what if the trace ends here; the monitor can go on all the same.

        Returns: with the reading `start` a mapping from requirements to `Final`, the robustness and verdict
                 that `evaluate` gives for the samples so far. With `every` a list of `Known` for all samples
                 not known yet.
        Raises:  DataError: there was no sample.
        """
        if self.n_samples == 0:
            refuse("D803", where=": the monitor has seen none")
        if self.reading == "every":
            return self._rest()
        rows = zip(self._bundle.requirements, self._objects.clock.ends(), strict=True)
        return {r.name: Final(shown(value), _verdict(value)) for r, (_, _, value) in rows}

    def _rest(self) -> list[Known]:
        opening, n = self._opening(), self.n_samples
        found: list[Known] = []
        for requirement, (first, columns) in zip(self._bundle.requirements, opening.open_samples(n), strict=True):
            values = columns[2].tolist()
            for i, (time, value) in enumerate(zip(opening.positions(first, n)[1].tolist(), values, strict=True)):
                found.append(Known(first + i, time, requirement.name, shown(value), _verdict(value)))
        return found

    def _opening(self) -> Opening:
        opening = self._objects.parts[self._program.opening]
        assert isinstance(opening, Opening)
        return opening

    def copy(self) -> "Monitor":
        """Return a monitor that has seen the same samples and goes its own way."""
        objects = self._program.objects()
        objects.load(self._objects.save())
        return Monitor(self._bundle, self._program, objects)

    def __copy__(self) -> "Monitor":
        """Return what `copy` does: `update` holds on to the memory, which field by field would stay shared."""
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> "Monitor":
        """Return what `copy` does, also for whoever copies an environment that holds a monitor."""
        return self.copy()

    def to_bytes(self) -> bytes:
        """Return the monitor's memory as JSON, to be restored with `from_bytes`."""
        document = {
            "schema": _SCHEMA,
            "meaning_sha256": meaning_sha256(self._bundle),
            "reading": self.reading,
            "ends": self.ends,
            "state": self._objects.save(),
        }
        if self._program.states is not None:
            document["states_sha256"] = self._program.states.sha256()
        return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()

    @classmethod
    def from_bytes(cls, bundle: BundleData, data: bytes, states: Table | None = None) -> "Monitor":
        """Restore a monitor of the same spec and the same states, if any; nothing in the bytes is executed.

        Raises: DataError D893: they are damaged, or were saved with another spec, states or version.
        """
        try:
            document = _document(data)
            if document.get("meaning_sha256") != meaning_sha256(bundle):
                raise Unsound("it was saved with another spec")
            reading, ends = document.get("reading"), document.get("ends")
            if reading not in ("start", "every") or ends not in ("any", "horizon"):
                raise Unsound("its reading is unknown")
            monitor = make_monitor(bundle, reading, ends, states)
            tables = monitor._program.states
            if document.get("states_sha256") != (None if tables is None else tables.sha256()):
                raise Unsound("it was saved with other states")
            monitor._objects.load(document.get("state"))
            wanted = len(bundle.requirements) if reading == "start" and monitor.n_samples else 0
            if len(monitor._objects.clock.ends()) != wanted:
                raise Unsound("it has another number of requirements")
            monitor.update = monitor._program.bind(monitor._objects)
        except Unsound as error:
            refuse("D893", problem=str(error))
        return monitor


def _document(data: bytes) -> dict[str, Any]:
    if len(data) > _LARGEST:
        raise Unsound("it is too large")
    try:
        document = json.loads(data.decode("utf-8"))
    except (ValueError, RecursionError):
        raise Unsound("it is not JSON") from None
    if not isinstance(document, dict) or document.get("schema") != _SCHEMA:
        raise Unsound(f"it is no {_SCHEMA} document")
    return document


def _verdict(value: float) -> Verdict:
    return Verdict.SATISFIED if value > 0 else Verdict.VIOLATED


def _columns(rows: Floats) -> Columns:
    low, high, current = rows.T
    return low, high, current


def _open(samples: NDArray[np.int64], times: Floats, columns: Columns) -> Open:
    low, high, current = columns
    for column in (samples, times, low, high, current):
        column.setflags(write=False)
    return Open(samples, times, low, high, current)


def make_monitor(
    bundle: BundleData, reading: Reading = "start", ends: Ends = "any", states: Table | None = None
) -> Monitor:
    """Make a monitor that has seen no sample yet.

    Not in the paper: it evaluates complete traces only.

    Args:
        bundle: the compiled spec.
        reading: "start" follows the requirements at sample 0, "every" at each sample.
        ends: "any": the trace may end after any sample, so no sample to come is certain. "horizon": it is
            promised to reach the horizon without a gap, which can make enclosures narrower.
        states: the values of the signals in every state of a finite state space, as a mapping to arrays
            (n_states,) or one array (n_states, n_signals) in the order of the spec. A sample is then the number
            of a state; the same is told as for its values, for less work. They are copied.

    Raises: UsageError: the reading or the end is unknown, or `states` has a wrong shape. DataError: a state has a
        value that no sample may have.
    """
    for name, given, known in (("reading", reading, ("start", "every")), ("ends", ends, ("any", "horizon"))):
        if given not in known:
            raise UsageError([diagnostic("D880", what=f"{name}={given!r}", help=f"use {known[0]} or {known[1]}")])
    plan = make_plan(bundle, ends)
    tables = None if states is None else make_states(bundle, plan, states)
    program = start_program(bundle, plan, tables) if reading == "start" else every_program(bundle, plan, tables)
    return Monitor(bundle, replace(program, ends=ends, states=tables), program.objects())


def late_warnings(bundle: BundleData) -> tuple[Diagnostic, ...]:
    """Return a warning for each requirement whose values the reading `every` knows at the end only."""
    return tuple(diagnostic("D894", requirement=name) for name in deferred(bundle, make_plan(bundle)))
