"""Which part of a demonstration shapes which segment.

In: demonstrations as Algorithm 1 ranks them. Out: for each segment, from a state to a goal, a reward map of its own.
Algorithm 3 takes the same R for every segment. R rises along a whole demonstration, so it leads a segment past its
goal, to the goals that the demonstration visited later; on 7x7 maps with two goals that took more steps than no
demonstrations at all. So each segment gets what Algorithm 1 makes of the parts that lead to its own goal.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from stlspec.envs.model import Environment
from stlspec.rewards import RankedStates, learner_reward, rising_values


@dataclass(frozen=True, slots=True)
class Way:
    """A demonstration that met the hard requirements: states of the environment learned in, rank, r_d >= 0."""

    states: tuple[int, ...]
    rank: int
    reward: float


def ways_of(ranked: Sequence[RankedStates], environment: Environment) -> tuple[Way, ...]:
    """Return the demonstrations that may lead somewhere.

    Paper: Algorithm 1, lines 8 and 9, good demonstrations; incomplete ones as decision 3 has it.

    Args:    ranked: all demonstrations. environment: learned in; it has every state of theirs.
    """
    found = []
    for demonstration in ranked:
        home = demonstration.environment
        worth = max(demonstration.values.values(), default=0.0)
        if demonstration.label != "bad" and worth > 0:
            states = tuple(environment.encode(home.decode(state)) for state in demonstration.states)
            found.append(Way(states, demonstration.rank, worth))
    return tuple(found)


def part_of(states: Sequence[int], start: int, goal: Sequence[bool]) -> Sequence[int]:
    """Return the part of a demonstration that leads to a goal.

    Not in the paper: it does not part demonstrations.

    Args:    states: of the demonstration. start: where the segment begins. goal: (n_states,), whether each state
             is the goal.
    Returns: from the last visit of `start` before the goal is reached from there, else from the beginning, to the
             first state of the goal; empty if there is no way to the goal.
    """
    begun = 0
    for sample, state in enumerate(states):
        if state == start and any(goal[s] for s in states[sample + 1 :]):
            begun = sample
    part = states[begun:]
    for sample, state in enumerate(part):
        if goal[state] and (sample or state != start):
            return part[: sample + 1]
    return ()


def segment_reward(ways: Sequence[Way], start: int, goal: Sequence[bool]) -> tuple[float, ...]:
    """Infer the reward of one segment.

    Paper: Algorithm 1 on the parts of the demonstrations that lead to the goal, each worth as much as the whole.

    Returns: (n_states,), in [0, 1]; all 0 if no demonstration leads there.
    """
    ranks, values = [], []
    for way in ways:
        part = part_of(way.states, start, goal)
        given: dict[int, float] = {}
        for state, value in zip(part, rising_values(way.reward, len(part)), strict=True):
            given[state] = max(value, given.get(state, 0.0))
        ranks.append(way.rank)
        values.append(given)
    table = [0.0] * len(goal)
    for state, value in learner_reward(ranks, values).items():
        table[state] = value
    return tuple(table)
