"""What goes wrong with Algorithm 2 as printed: a policy that circles for reward and never arrives.

In: the greedy path of a policy trained by the method `paper`. Out: the cycle that it ends in, if it does,
and what circling pays beside what going to the goal pays. Both returns come from the paper's own reward, so
that the report shows that the learner is right and the reward is wrong.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from stlspec.learning.qstl import feedback
from stlspec.learning.shaping import GOAL, RUNS
from stlspec.learning.task import Task


@dataclass(frozen=True, slots=True)
class Farming:
    """A cycle of states that the greedy policy never leaves.

    cycle: its states, from the one where it is entered, each once. return_cycle: the discounted return of
    circling for ever; to_goal: the shortest safe path from the same state; return_goal: its discounted
    return. Both are None where no safe path leads to the goal.
    """

    cycle: tuple[int, ...]
    return_cycle: float
    to_goal: tuple[int, ...] | None
    return_goal: float | None


def find_farming(task: Task, path: Sequence[int], reward: Sequence[float], gamma: float) -> Farming | None:
    """Look for a cycle at the end of a greedy path, and compare circling with going to the goal.

    Not in the paper: it is what we found when we ran Algorithm 2. Both returns are taken from the state where
    the cycle is entered, with the robustness of the path up to there, as the learner would receive them.

    Args:    task: tables over states. path: the greedy path, as long as it went. reward: (n_states,), R.
             gamma: the discount, in [0, 1].
    Returns: the cycle and both returns; None if no state occurs twice.
    """
    entry, length = first_cycle(path)
    if length == 0:
        return None
    lows = tuple(map(min, zip(*(task.robustness[s] for s in path[: entry + 1]), strict=True)))
    lap = [*path[entry + 1 : entry + length], path[entry]]
    # from the second lap on the running minima no longer change
    first, settled = _rewards(task, lap, lows, reward)
    later, _ = _rewards(task, lap, settled, reward)
    to_goal = shortest_safe_path(task.transitions, task.endings, path[entry])
    return Farming(
        tuple(path[entry : entry + length]),
        circling_return(first, later, gamma),
        to_goal,
        None if to_goal is None else discounted(_rewards(task, to_goal[1:], lows, reward)[0], gamma),
    )


def describe(found: Farming | None, names: Sequence[object]) -> str:
    """Say in one line whether a policy farms. Not in the paper: the report.

    Args:    found: what `find_farming` gave. names: of the states.
    """
    if found is None:
        return "the greedy path does not farm: it visits no state twice"
    cycle = " -> ".join(str(names[s]) for s in (*found.cycle, found.cycle[0]))
    circling = f"the greedy path farms: it circles {cycle} for a discounted return of {found.return_cycle:.4g}"
    if found.return_goal is None:
        return f"{circling}; no safe path leads from there to the goal"
    return f"{circling}, while going to the goal returns {found.return_goal:.4g}"


def first_cycle(path: Sequence[int]) -> tuple[int, int]:
    """Return the index at which the first repeated state of a path stands, and the steps until it recurs.

    Not in the paper. Returns: (index, length); (0, 0) if no state occurs twice.
    """
    seen: dict[int, int] = {}
    for index, state in enumerate(path):
        if state in seen:
            return seen[state], index - seen[state]
        seen[state] = index
    return 0, 0


def _rewards(
    task: Task, states: Sequence[int], lows: Sequence[float], reward: Sequence[float]
) -> tuple[list[float], tuple[float, ...]]:
    """Return the paper's reward for entering each of `states` in turn, and the running minima after them."""
    out = []
    for state in states:
        lows = tuple(map(min, lows, task.robustness[state]))
        out.append(reward[state] + feedback(lows))
    return out, tuple(lows)


def discounted(rewards: Sequence[float], gamma: float) -> float:
    """Return the sum of gamma^k * rewards[k]. Not in the paper: the usual definition."""
    total = 0.0
    for value in reversed(rewards):
        total = value + gamma * total
    return total


def circling_return(first: Sequence[float], later: Sequence[float], gamma: float) -> float:
    """Return the discounted return of one lap followed by endlessly many equal ones.

    Not in the paper: the geometric series.

    Args:    first: the rewards of the first lap. later: those of every later lap, as many.
             gamma: the discount, in [0, 1]; at 1 the sum is infinite unless a lap pays 0.
    Returns: the return.
    """
    lap = discounted(later, gamma)
    if gamma == 1 and lap != 0:
        return inf if lap > 0 else -inf
    shrink: float = gamma ** len(first)
    endless = 0.0 if lap == 0 else shrink * lap / (1 - shrink)
    return discounted(first, gamma) + endless


def shortest_safe_path(
    transitions: Sequence[Sequence[int]], endings: Sequence[int], start: int
) -> tuple[int, ...] | None:
    """Search breadth first, actions in order, for the goal through states in which an episode runs on.

    Not in the paper: a search on the known map, for comparison only; the learner never uses it.

    Returns: the states from `start` to the goal; None if there is no such path.
    """
    before: dict[int, int] = {start: start}
    queue = deque([start])
    while queue:
        state = queue.popleft()
        if endings[state] == GOAL:
            path = [state]
            while path[-1] != start:
                path.append(before[path[-1]])
            return tuple(reversed(path))
        for after in transitions[state] if endings[state] == RUNS else ():
            if after not in before:
                before[after] = state
                queue.append(after)
    return None
