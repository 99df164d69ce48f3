"""What a policy needs to remember: where it is on its way through several goals, and what has happened so far.

In: observations, one after the other, as numbers of the environment's states. Out: actions. A `Route` is data,
as it stands in policy.json; a `Walk` is where one episode has come to. Nothing that an environment can show it
makes it fail: a state that it cannot have come to is taken as a fresh start from there.
"""

from dataclasses import dataclass
from typing import Any

from stlspec.documents import DamageError


@dataclass(frozen=True, slots=True)
class Stage:
    """The way to one goal.

    goal: its name. reached: the learner states in which it is reached. actions: (n_states,), the greedy
    action in each learner state. q: (n_states, n_actions).
    """

    goal: str
    reached: frozenset[int]
    actions: tuple[int, ...]
    q: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class Route:
    """Learner states and the stages of the way.

    places: (n_states,), the state of the environment in each learner state. start: the first one.
    transitions: (n_states, n_actions), the learner states that may follow.
    """

    places: tuple[int, ...]
    start: int
    transitions: tuple[tuple[int, ...], ...]
    stages: tuple[Stage, ...]

    def to_json(self) -> dict[str, Any]:
        """Return the part of policy.json that a route takes; infinite values are masked actions."""
        return {
            "places": list(self.places),
            "start": self.start,
            "transitions": [list(row) for row in self.transitions],
            "stages": [
                {
                    "goal": stage.goal,
                    "reached": sorted(stage.reached),
                    "actions": list(stage.actions),
                    "q": [[v if abs(v) != float("inf") else "-inf" for v in row] for row in stage.q],
                }
                for stage in self.stages
            ],
        }


class Walk:
    """Where an episode has come to on a route: `state`, a learner state, and the number of the stage."""

    def __init__(self, route: Route) -> None:
        self.route = route
        self.stage = 0
        self.state: int | None = None
        self._first = {place: state for state, place in reversed(list(enumerate(route.places)))}

    def reset(self) -> None:
        """Begin an episode."""
        self.stage, self.state = 0, None

    def step(self, place: int) -> int | None:
        """Take in the next state of the environment.

        Not in the paper: it concatenates paths; a policy has to know which part it is in.

        Args:    place: the number of a state of the environment.
        Returns: the action; None if no learner state is in that place, and then nothing changes.
        """
        after = self._after(place)
        if after is None:
            return None
        self.state = after
        stages = self.route.stages
        while self.stage + 1 < len(stages) and after in stages[self.stage].reached:
            self.stage += 1
        return stages[self.stage].actions[after]

    def _after(self, place: int) -> int | None:
        route = self.route
        if self.state is not None:
            for state in route.transitions[self.state]:
                if route.places[state] == place:
                    return state
        # an episode begins here, or somebody moved us: what happened before is unknown
        self.stage = 0 if self.state is None else self.stage
        return route.start if route.places[route.start] == place else self._first.get(place)


def read_route(document: Any, n_places: int, n_actions: int) -> Route:
    """Read the part of policy.json that `Route.to_json` writes.

    Args:    n_places, n_actions: of the environment.
    Raises:  DamageError: it is not such a part.
    """
    try:
        places = tuple(_index(x, n_places) for x in document["places"])
        n_states = len(places)
        transitions = tuple(tuple(_index(x, n_states) for x in row) for row in document["transitions"])
        stages = tuple(_stage(x, n_states, n_actions) for x in document["stages"])
        start = _index(document["start"], n_states)
    except (TypeError, KeyError, ValueError, OverflowError) as error:
        raise DamageError(f"its 'route' is damaged: {str(error)[:60]}") from None
    if len(transitions) != n_states or any(len(row) != n_actions for row in transitions) or not stages:
        raise DamageError("its 'route' has lists of the wrong length")
    return Route(places, start, transitions, stages)


def _stage(document: Any, n_states: int, n_actions: int) -> Stage:
    actions = tuple(_index(x, n_actions) for x in document["actions"])
    q = tuple(tuple(-float("inf") if x == "-inf" else _number(x) for x in row) for row in document["q"])
    if len(actions) != n_states or len(q) != n_states or any(len(row) != n_actions for row in q):
        raise ValueError("a stage has lists of the wrong length")
    return Stage(str(document["goal"]), frozenset(_index(x, n_states) for x in document["reached"]), actions, q)


def _index(value: Any, limit: int) -> int:
    if type(value) is not int or not 0 <= value < limit:
        raise ValueError(f"{str(value)[:20]} is no number from 0 to {limit - 1}")
    return value


def _number(value: Any) -> float:
    if type(value) not in (int, float) or value != value:
        raise ValueError(f"{str(value)[:20]} is no number")
    return float(value)
