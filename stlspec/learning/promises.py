"""The potential of the method `shaped`: what demonstrations promise, for as long as nothing contradicts it.

In: the reward map, and which pairs of state and action have been tried. Out: `Promises`, a potential Phi that
starts as the reward map says and only ever loses. Potential-based shaping with Phi is the same learner as
Q-learning on the base reward whose values start at Phi (Wiewiora 2003): shaped values plus Phi are the values
kept here, so that a promise is added to the row of a state when it is first reached, and subtracted again when
it proves empty. The optimal policies stay whatever Phi does (Devlin and Kudenko 2012).
"""

from collections.abc import Iterable, Sequence
from math import inf
from typing import Any

from stlspec.learning.shaping import RUNS, UNTRIED, Move

AT_HOME = 0.5
"""What a state with the least reward promises on the very map that the demonstrations were made on."""

ELSEWHERE = 0.95
"""The same on another map, where the order of the states may mislead: all promise almost as much as the goal."""

TOLERANCE = 0.001
"""A promise is corrected if it is too large by more than this; hence finitely often."""


def promised(reward: Sequence[float], least: float) -> tuple[float, ...]:
    """Turn a reward map into a potential on the scale of the base reward, whose goal pays 1.

    Paper: section 3.2, the potential. Not in the paper: the scale, and that negative rewards, which only bad
    demonstrations give, promise nothing (the mask is for them).

    Args:    reward: (n_states,), R in [-1, 1]. least: the promise of a positive reward near 0, in [0, 1].
    Returns: (n_states,), in [0, 1]: from `least` to 1 where R is positive, else 0.
    """
    return tuple(least + (1 - least) * value if value > 0 else 0.0 for value in reward)


class Promises:
    """The potential of every state, as far as it is known, and what has been seen of the transitions.

    claims: (n_states,), Phi now; 0 where a state has not been reached. tried: pairs of state and action in the
    order in which they were first taken. A state promises at least as much as the state from which it is first
    reached, and the start as the least of all: leaving the demonstrated path costs nothing by itself.
    """

    def __init__(self, potentials: Sequence[float], start: int) -> None:
        self.potentials = tuple(potentials)
        self.claims: list[float] = [0] * len(potentials)
        self.reached = [False] * len(potentials)
        self.tried: list[tuple[int, int]] = []
        self.before: list[list[int]] = [[] for _ in potentials]
        self.reach(start, min((value for value in potentials if value > 0), default=0))

    def reach(self, state: int, inherited: float) -> float:
        """Reach a state, from one that promises `inherited`; return what it promises if that is news, else 0."""
        if self.reached[state]:
            return 0
        self.reached[state] = True
        self.claims[state] = max(self.potentials[state], inherited)
        return self.claims[state]

    def note(self, state: int, action: int, after: int) -> None:
        """Remember that `action` was taken in `state` for the first time, and led to `after`."""
        self.tried.append((state, action))
        self.before[after].append(state)

    def to_state(self) -> dict[str, Any]:
        """Return what a checkpoint holds."""
        return {"tried": [list(pair) for pair in self.tried], "claims": self.claims}

    def correct(
        self,
        states: Iterable[int],
        moves: Sequence[Sequence[Move]],
        choices: Sequence[Sequence[int]],
        gamma: float,
    ) -> list[tuple[int, float]]:
        """Lower the promises of `states`, and of those that rely on them, to what their actions can keep.

        Not in the paper: the remedy for a map on which the demonstrations mislead. A state all of whose
        actions have been tried cannot be worth more than the best of base reward + gamma * Phi(next state).
        On the map of a demonstration its states hold to that, for Phi rises along it faster than a step costs.

        Args:    states: where something new is known. moves: what each action does, `UNTRIED` where unknown.
                 choices: the actions allowed in each state. gamma: the discount.
        Returns: (state, loss) in the order of the corrections; losses are above `TOLERANCE`.
        """
        losses = []
        pending = list(states)
        while pending:
            state = pending.pop()
            claim = self.claims[state]
            if claim <= 0:
                continue
            kept = self._kept(moves[state], choices[state], gamma)
            if kept < claim - TOLERANCE:
                self.claims[state] = kept
                losses.append((state, claim - kept))
                pending.extend(self.before[state])
        return losses

    def _kept(self, moves: Sequence[Move], choices: Sequence[int], gamma: float) -> float:
        """Return the largest promise that the actions of a state can keep; infinite if one is untried."""
        best: float = 0
        for action in choices:
            after, reward, ending = moves[action]
            if ending == UNTRIED:
                return inf
            best = max(best, reward + gamma * self.claims[after] if ending == RUNS else reward)
        return best
