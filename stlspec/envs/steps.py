"""Whether recorded steps can be steps of an environment.

In: an environment whose transitions are known, states by number, actions as recorded. Out: the first step that it
cannot have taken, and how many there are: a log that leaves out samples, actions of another numbering, another map.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from stlspec.envs.model import Environment


@dataclass(frozen=True, slots=True)
class WrongStep:
    """The first step that is none: from `sample` to the next. what: is wrong with it. count: of all such steps.

    by_action: whether the states alone would do, so that the action is what is wrong.
    """

    sample: int
    what: str
    by_action: bool
    count: int


def wrong_step(environment: Environment, states: Sequence[int], actions: Sequence[Any] | None) -> WrongStep | None:
    """Find the first step of a recording that the environment cannot have taken.

    Not in the paper, which takes demonstrations as given. Where transitions are by chance, all that can happen can
    have happened.

    Args:    states: (n_samples,) numbers of states. actions: (n_samples - 1,), each as recorded, None where unknown.
    Returns: None if all steps are possible, or if the environment does not know its transitions.
    """
    if environment.transitions is None and environment.outcomes is None:
        return None
    known: dict[tuple[int, int, Any], tuple[str, bool] | None] = {}
    found: list[tuple[int, tuple[str, bool]]] = []
    for sample, (before, after) in enumerate(pairwise(states)):
        key = (before, after, None if actions is None else _plain(actions[sample]))
        if key not in known:
            known[key] = _judged(environment, *key)
        wrong = known[key]
        if wrong is not None:
            found.append((sample, wrong))
    if not found:
        return None
    sample, (what, by_action) = found[0]
    return WrongStep(sample, what, by_action, len(found))


def _judged(environment: Environment, before: int, after: int, action: Any) -> tuple[str, bool] | None:
    """Say what is wrong with one step, and whether it is the action; None if nothing is."""
    n_actions = environment.n_actions
    leading = [a for a in range(n_actions) if after in _reached(environment, before, a)]
    start, end = environment.decode(before), environment.decode(after)
    if not leading:
        return f"no action leads from {start} to {end}", False
    if action is None or action in leading:
        return None
    if type(action) is not int or not 0 <= action < n_actions:
        shown = repr(action)[:40]
        return f"its action is {shown}, and actions are 0 to {n_actions - 1}", True
    others = " or ".join(map(str, leading))
    return f"action {action} does not lead from {start} to {end}, but action {others} does", True


def _reached(environment: Environment, state: int, action: int) -> tuple[int, ...]:
    if environment.transitions is not None:
        return (environment.transitions[state][action],)
    assert environment.outcomes is not None
    return tuple(after for probability, after in environment.outcomes[state][action] if probability > 0)


def _plain(action: Any) -> Any:
    """Return an action as a plain number where it is one, alone in a list too; None where it is not known."""
    value = action.tolist() if hasattr(action, "tolist") else action
    if isinstance(value, list | tuple) and len(value) == 1:
        value = value[0]
    if type(value) is float and math.isnan(value):
        return None
    if type(value) is float and value.is_integer():
        return int(value)
    return value if value is None or type(value) in (int, float) else str(value)
