"""One demonstration while it is made, and what a spec says of it so far.

In: moments and actions. Out: `Take`, immutable, so that undoing is keeping an older one; `Follower`, which asks the
online monitor. The monitor is fed by the same function that scoring reads a demonstration with, so that what is
shown live is what the score will say.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from stlspec.binding import BoundDemonstration, bind
from stlspec.compiler.bundle import BundleData
from stlspec.demos import Demonstration, make_demonstration
from stlspec.envs.model import Environment
from stlspec.errors import InputError, UsageError, diagnostic
from stlspec.semantics.online import Monitor, Standing, make_monitor
from stlspec.tools.record.world import Moment

_KEPT = 64
"""So many copies of the monitor are kept for going back; further back it sees the samples again."""


@dataclass(frozen=True, slots=True)
class Take:
    """Moments and the actions between them; episode: which dice it was made with."""

    episode: int
    moments: tuple[Moment, ...]
    actions: tuple[int, ...] = ()

    def then(self, action: int, moment: Moment) -> "Take":
        """Return the take after one more step."""
        return Take(self.episode, (*self.moments, moment), (*self.actions, action))

    def before(self) -> "Take":
        """Return the take before its last step."""
        return Take(self.episode, self.moments[:-1], self.actions[:-1])

    @property
    def ended(self) -> str:
        """Why no step can follow, in words; "" if one can."""
        return self.moments[-1].ended

    def demonstration(self, name: str, environment: Environment, bundle: BundleData | None) -> Demonstration:
        """Return it as a demonstration; signals that the spec reads from info become columns."""
        keys = {s.source or s.name for s in bundle.signals} if bundle is not None else set()
        columns = {key: self._column(key) for key in sorted(keys) if key.startswith("info.")}
        return make_demonstration(
            name,
            columns,
            states=[moment.state for moment in self.moments],
            actions=self.actions,
            env=environment.describe(),
        )

    def _column(self, key: str) -> list[float]:
        found = []
        for moment in self.moments:
            value: Any = moment.info
            for step in key.split(".")[1:]:
                value = value.get(step) if isinstance(value, Mapping) else None
            found.append(float(value) if isinstance(value, int | float) else math.nan)
        return found


@dataclass(frozen=True, slots=True)
class Standings:
    """What is known of a take: standings of the requirements, values of the signals; trouble: why there are none."""

    requirements: Mapping[str, Standing] = field(default_factory=dict)
    signals: Mapping[str, float | bool] = field(default_factory=dict)
    trouble: str = ""


class Follower:
    """Follows takes with the online monitor."""

    def __init__(self, bundle: BundleData, environment: Environment) -> None:
        """Prepare. Raises: UsageError D885: the spec wants time stamps, which steps do not have."""
        if bundle.time.kind == "stamps":
            reason = f"its steps take no time, but the spec counts in {bundle.time.unit}"
            way = "write `time step`, or a sampling period such as `time 100 ms`"
            raise UsageError([diagnostic("D885", id=environment.id, reason=reason, help=way)])
        self._bundle, self._environment = bundle, environment
        used = {node.value for node in bundle.nodes if node.op in ("signal", "bool")}
        sources = [s.source or s.name for s in bundle.signals if s.name in used]
        # The first sample takes the action that leaves it, so it is not known before there is one.
        self._waits = any(source == "action" or source.startswith(("action.", "action[")) for source in sources)
        self._kept: list[tuple[Take, Monitor, Mapping[str, Standing]]] = []

    def check(self, take: Take) -> None:
        """Refuse a spec whose signals the environment does not offer. Raises: InputError: as `binding.bind`."""
        if not self._waits:
            self._bound(take)

    def standings(self, take: Take) -> Standings:
        """Say what is known of a take."""
        if self._waits and not take.actions:
            return Standings(trouble="The first action is still to come; the spec reads it at sample 0.")
        try:
            bound = self._bound(take)
            known = self._known(take, bound)
        except InputError as error:
            return Standings(trouble=error.diagnostics[0].message)
        return Standings(known, {name: values[-1].item() for name, values in bound.signals.items()})

    def _bound(self, take: Take) -> BoundDemonstration:
        made = take.demonstration(f"a recording in {self._environment.id}", self._environment, self._bundle)
        # The environment is at hand; it need not be made again from its description.
        made = replace(made, recording=replace(made.recording, env=None))
        return bind(self._bundle, made, self._environment)

    def _known(self, take: Take, bound: BoundDemonstration) -> Mapping[str, Standing]:
        monitor, known, seen = make_monitor(self._bundle), dict[str, Standing](), 0
        while self._kept:
            older, kept, told = self._kept[-1]
            seen = len(older.moments)
            # A take that goes on from an older one holds the very same moments.
            if seen <= len(take.moments) and older.moments[-1] is take.moments[seen - 1]:
                monitor, known = kept.copy(), dict(told)
                break
            self._kept.pop()
            seen = 0
        for sample in range(seen, len(take.moments)):
            known = dict(monitor.update({name: values[sample].item() for name, values in bound.signals.items()}))
        if seen < len(take.moments):
            self._kept = [*self._kept[1 - _KEPT :], (take, monitor, known)]
        return known
