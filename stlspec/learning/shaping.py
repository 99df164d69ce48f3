"""The reward of one step: the base reward, and the potential that the demonstrations add to it.

In: how a step ends, the potential of the state it leaves and of the one it enters. Out: numbers. The base
reward is worked out once for each pair of state and action before training, so that a step of training only
looks up; the tabular learner keeps its potential in the values that it starts from (see `promises`), other
learners add it with `shaped_reward`. The functions take any number type, so that a test can prove with
fractions that shaping is harmless.
"""

from collections.abc import Sequence

RUNS, GOAL, VIOLATION, TERMINAL, LIMIT, AVOIDED = range(6)
"""How an episode stands after a step: it runs on, or ended at the goal, at the violation of a hard
requirement, in a terminal state of the environment, at the step limit (which no state decides), or in a state
that breaks what a soft requirement keeps up."""

ENDINGS = ("runs", "goal", "violation", "terminal", "limit", "avoided")
"""The names of these, as the log has them."""

UNTRIED = len(ENDINGS)
"""In a table of moves: the action has not been taken yet, so how the episode stands after it is to be looked up."""

Move = tuple[int, float, int]
"""What taking an action does: the next state, the reward, and how the episode stands there."""


def base_reward(ending: int, step_cost: float) -> float:
    """Reward a step by how it ends: +1 at the goal, -1 at any other end, less the cost of a step.

    Not in the paper: its rewards are all positive along a demonstration, so that going round in circles
    beside the goal pays more than arriving. An environment that ends elsewhere leaves no way to the goal, as a
    violation does: were it free, ending soon would save the cost of the steps to come.

    Args:    ending: any but `LIMIT`; `AVOIDED` counts as a violation. step_cost: what every step costs, >= 0.
    Returns: the reward, no unit.
    """
    return {GOAL: 1, VIOLATION: -1, AVOIDED: -1, TERMINAL: -1}.get(ending, 0) - step_cost


def shaped_reward(base: float, potential: float, next_potential: float, gamma: float) -> float:
    """Add what the potential gains on a step: base + gamma * Phi(s') - Phi(s).

    Paper: section 3.2, which refers to potential-based shaping (Ng, Harada and Russell 1999). Phi(s') must be
    0 where an episode terminates: then the sum over an episode changes by -Phi(start) whatever the policy,
    and the optimal policies stay.

    Args:    base: the reward without shaping. potential, next_potential: Phi of the state left and entered.
             gamma: the discount, in [0, 1].
    Returns: the reward, no unit.
    """
    return base + gamma * next_potential - potential


def moves(
    transitions: Sequence[Sequence[int]], endings: Sequence[int], step_cost: float, payoffs: Sequence[float] = ()
) -> list[list[Move]]:
    """Work out, for every state and action, where it leads, what it pays, and whether it ends the episode.

    Not in the paper: it makes a step of training a look-up.

    Args:    transitions: (n_states, n_actions), the next states. endings: (n_states,), how an episode stands
             in each state. step_cost: what every step costs. payoffs: (n_states,), what entering each state pays
             besides, () = nothing.
    Returns: (n_states, n_actions) moves with the base reward, in lists, which the learner may change.
    """
    paid = [base_reward(ending, step_cost) for ending in endings]
    if payoffs:
        paid = [base + more for base, more in zip(paid, payoffs, strict=True)]
    return [[(after, paid[after], endings[after]) for after in row] for row in transitions]
