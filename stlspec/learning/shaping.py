"""The reward of one step: the base reward, and the potential that the demonstrations add to it.

In: how a step ends, the potential of the state it leaves and of the one it enters. Out: numbers. Everything
is worked out once for each pair of state and action before training, so that a step of training only looks
up; the functions take any number type, so that a test can prove with fractions that shaping is harmless.
"""

from collections.abc import Sequence

RUNS, GOAL, VIOLATION, TERMINAL, LIMIT, AVOIDED = range(6)
"""How an episode stands after a step: it runs on, or ended at the goal, at the violation of a hard
requirement, in a terminal state of the environment, at the step limit (which no state decides), or in a state
that breaks what a soft requirement keeps up."""

ENDINGS = ("runs", "goal", "violation", "terminal", "limit", "avoided")
"""The names of these, as the log has them."""

Move = tuple[int, float, int]
"""What taking an action does: the next state, the reward, and how the episode stands there."""


def base_reward(ending: int, step_cost: float) -> float:
    """Reward a step by how it ends: +1 at the goal, -1 at a violation, less the cost of a step.

    Not in the paper: its rewards are all positive along a demonstration, so that going round in circles
    beside the goal pays more than arriving.

    Args:    ending: any but `LIMIT`; `AVOIDED` counts as a violation. step_cost: what every step costs, >= 0.
    Returns: the reward, no unit.
    """
    return {GOAL: 1, VIOLATION: -1, AVOIDED: -1}.get(ending, 0) - step_cost


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
    transitions: Sequence[Sequence[int]],
    endings: Sequence[int],
    potentials: Sequence[float] | None,
    gamma: float,
    step_cost: float,
) -> list[list[Move]]:
    """Work out, for every state and action, where it leads, what it pays, and whether it ends the episode.

    Not in the paper: it makes a step of training a look-up.

    Args:    transitions: (n_states, n_actions), the next states. endings: (n_states,), how an episode stands
             in each state. potentials: (n_states,), Phi; None = no shaping (the matched baseline).
             gamma: the discount. step_cost: what every step costs.
    Returns: (n_states, n_actions) moves, in lists, which the mask may change.
    """
    table = []
    for state, row in enumerate(transitions):
        out = []
        for after in row:
            ending = endings[after]
            reward = base_reward(ending, step_cost)
            if potentials is not None:
                ahead = potentials[after] if ending == RUNS else 0
                reward = shaped_reward(reward, potentials[state], ahead, gamma)
            out.append((after, reward, ending))
        table.append(out)
    return table
