"""The policy that comes out of training: one action for every state.

In: a Q table, or the `policy.json` of a finished run. Out: the greedy path, and `Policy`, whose `act` takes
an observation of the environment as gymnasium gives it. With several goals, or where hard requirements have
memory, the action depends on the way there too: then there is a `Route`. A policy file is data: it is checked
before use, and carries the names of its states, so that acting needs neither the spec nor the environment.
"""

import operator
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Any

from stlspec.documents import DamageError, State, read_document, read_state
from stlspec.envs.bins import Bins, read_bins
from stlspec.envs.gridworld import register
from stlspec.errors import DataError, diagnostic
from stlspec.learning.route import Route, Walk, read_route
from stlspec.learning.shaping import RUNS

SCHEMA = "stlspec.policy/1"
FILE = "policy.json"
_LARGEST_FILE = 256 * 2**20


def greedy_action(values: Sequence[float]) -> int:
    """Return the action of the largest value, the lowest on ties. Paper: Algorithm 2, its last line."""
    return values.index(max(values))


def greedy_path(
    q: Sequence[Sequence[float]],
    transitions: Sequence[Sequence[int]],
    endings: Sequence[int],
    start: int,
    max_steps: int,
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Follow the best actions from the start until an episode would end.

    Paper: Algorithm 2, "policy from start".

    Args:    q: (n_states, n_actions). transitions: the next states. endings: (n_states,), `RUNS` where an
             episode goes on. max_steps: the step limit.
    Returns: n + 1 states and n actions, n <= max_steps.
    """
    state, first_visit = start, {start: 0}
    states, actions = [start], list[int]()
    while endings[state] == RUNS and len(actions) < max_steps:
        actions.append(greedy_action(q[state]))
        state = transitions[state][actions[-1]]
        states.append(state)
        if state in first_visit:
            # from here on it repeats itself up to the step limit
            entry = first_visit[state]
            laps = max_steps // (len(actions) - entry)
            states = (states + states[entry + 1 :] * laps)[: max_steps + 1]
            actions = (actions + actions[entry:] * laps)[:max_steps]
            break
        first_visit[state] = len(actions)
    return tuple(states), tuple(actions)


@dataclass(frozen=True, slots=True)
class Policy:
    """A greedy policy: `actions[k]` is the action in `states[k]`, `q[k]` the values it was chosen by.

    environment: the description of the environment that it was learned in. A masked action has Q = -inf.
    bins: what numbers observations that are no states themselves; None = they are states.
    route: what to remember within an episode; None = nothing, and a call of `act` changes nothing. With a
    route, `actions` and `q` are those of its first stage, before anything has happened.
    """

    environment: MappingProxyType[str, Any]
    n_actions: int
    states: tuple[State, ...]
    actions: tuple[int, ...]
    q: tuple[tuple[float, ...], ...]
    route: Route | None = None
    bins: Bins | None = None
    _walk: Walk | None = field(init=False, repr=False, compare=False)
    _rows: dict[State, int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_walk", None if self.route is None else Walk(self.route))
        object.__setattr__(self, "_rows", {state: row for row, state in enumerate(self.states)})

    def reset(self) -> None:
        """Forget what happened: call it when an episode begins. Without a route there is nothing to forget."""
        if self._walk is not None:
            self._walk.reset()

    def act(self, observation: Any) -> int:
        """Return the action to take.

        Not in the paper: the way out of the product, into the user's own loop.

        With a route, call it once for each observation of an episode, the first included: it keeps track of the
        goals reached and of what hard requirements remember. A state that cannot follow on the last one is
        taken as it is, without a past.

        Args:    observation: the number of a state, or [row, col]; numbers may be numpy's.
        Returns: the number of an action.
        Raises:  DataError D874: the observation is no state of the policy.
        """
        row = self._row(observation)
        action = None if row is None else self.actions[row] if self._walk is None else self._walk.step(row)
        if action is None:
            example = list(self.states[0]) if isinstance(self.states[0], tuple) else self.states[0]
            shown = repr(observation)[:60]
            raise DataError(
                [diagnostic("D874", observation=shown, states=len(self.states), example=f"such as {example}")]
            )
        return action

    def _row(self, observation: Any) -> int | None:
        if self.bins is not None:
            try:
                return self.bins.number(observation)
            except (ValueError, TypeError, OverflowError):
                return None
        if getattr(observation, "ndim", None) == 1:
            observation = observation.tolist()
        try:
            if isinstance(observation, list | tuple):
                row, column = map(operator.index, observation)
                return self._rows.get((row, column))
            number = operator.index(observation)
        except (TypeError, ValueError):
            return None
        return number if 0 <= number < len(self.states) else None

    def to_json(self) -> dict[str, Any]:
        """Return the document that `load_policy` reads; the row of a state is its number."""
        more = {} if self.route is None else {"route": self.route.to_json()}
        if self.bins is not None:
            more["bins"] = self.bins.to_json()
        return {
            "schema": SCHEMA,
            "env": dict(self.environment),
            "n_actions": self.n_actions,
            "states": [list(s) if isinstance(s, tuple) else s for s in self.states],
            "actions": list(self.actions),
            "q": [[v if isfinite(v) else ("inf" if v > 0 else "-inf") for v in row] for row in self.q],
            **more,
        }


def load_policy(path: str | Path) -> Policy:
    """Read the policy of a finished run.

    Not in the paper: see `Policy.act`.

    Args:    path: the directory given as `out`, or the policy.json in it.
    Returns: the policy.
    Raises:  DataError D873: there is no policy, or the file is damaged.
    """
    # whoever loads a policy acts in its environment, perhaps by gymnasium.make
    register()
    place = Path(path)
    if place.is_dir():
        place = place / FILE
    try:
        return _policy(read_document(place, SCHEMA, _LARGEST_FILE))
    except DamageError as error:
        raise DataError([diagnostic("D873", file=str(place), problem=str(error))]) from None


def _policy(document: dict[str, Any]) -> Policy:
    environment, n_actions = document.get("env"), document.get("n_actions")
    if not isinstance(environment, dict) or type(n_actions) is not int or n_actions < 1:
        raise DamageError("'env' or 'n_actions' is missing or of the wrong type")
    states, actions, q = (_list(document, key) for key in ("states", "actions", "q"))
    if not len(states) == len(actions) == len(q):
        raise DamageError("'states', 'actions' and 'q' differ in length")
    named = tuple(read_state(x) for x in states)
    if len(set(named)) < len(named):
        raise DamageError("a state occurs twice")
    return Policy(
        MappingProxyType(environment),
        n_actions,
        named,
        tuple(_action(x, n_actions) for x in actions),
        tuple(_values(x, n_actions) for x in q),
        read_route(document["route"], len(named), n_actions) if "route" in document else None,
        _bins(document["bins"], len(named)) if "bins" in document else None,
    )


def _bins(document: Any, n_states: int) -> Bins:
    try:
        bins = read_bins(document)
    except (KeyError, TypeError, ValueError):
        raise DamageError("'bins' is damaged") from None
    if bins.size != n_states:
        raise DamageError("'bins' has another number of states")
    return bins


def _list(document: dict[str, Any], key: str) -> list[Any]:
    value = document.get(key)
    if not isinstance(value, list) or not value:
        raise DamageError(f"'{key}' must be a list that is not empty")
    return value


def _action(value: Any, n_actions: int) -> int:
    if type(value) is int and 0 <= value < n_actions:
        return value
    raise DamageError(f"{str(value)[:40]!r} is not an action from 0 to {n_actions - 1}")


def _values(row: Any, n_actions: int) -> tuple[float, ...]:
    if not isinstance(row, list) or len(row) != n_actions:
        raise DamageError(f"a row of 'q' does not have {n_actions} values")
    named = {"inf": inf, "-inf": -inf}
    values = [named.get(x, x) if isinstance(x, str) else x for x in row]
    try:
        if all(type(x) in (int, float) and x == x for x in values):
            return tuple(map(float, values))
    except OverflowError:
        pass  # an integer beyond every float
    raise DamageError("a value of 'q' is not a number")
