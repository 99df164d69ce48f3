"""Algorithm 2: Q-learning that watches the hard requirements at every step.

In: a `Task` (tables over learner states) and `Settings`. Out: a `Learner`, whose Q table, mask and log have
grown by some episodes. States are row numbers and everything is in Python lists: a step of training is a handful of
look-ups, many times faster than arrays at this size. A masked action has Q = -inf, so that the maximum over
allowed actions is the maximum over the row.
"""

from collections.abc import Iterable, Sequence
from functools import cached_property
from math import fsum, inf

import numpy as np

from stlspec.learning.promises import Promises
from stlspec.learning.settings import Settings
from stlspec.learning.shaping import AVOIDED, LIMIT, RUNS, UNTRIED, VIOLATION, Move, base_reward, moves
from stlspec.learning.task import Task

CHUNK = 25
"""Episodes between two looks at the greedy path; each chunk has random numbers of its own."""

LARGEST_ROBUSTNESS = 1e100

_BLOCK = 1024


class Learner:
    """What training changes.

    q: (n_states, n_actions), values of the base reward: shaped values plus the potential of the state.
    reward: the potential for the method shaped, R for the method paper, unused by plain. promises: the
    potential as it is now; None without shaping. moves: what each action does; choices: the actions still
    allowed; endings: how an episode stands in each state. steps, returns, outcomes: the log, one entry for
    each episode; a return is the sum of the rewards before shaping, without discount. violations: steps that
    violated.
    """

    def __init__(self, task: Task, settings: Settings, reward: Sequence[float]) -> None:
        self.task = task
        self.settings = settings
        self.reward = tuple(reward)
        self.endings = list(task.endings)
        self.q = [[0.0] * task.n_actions for _ in range(task.n_states)]
        self.choices = [list(range(task.n_actions)) for _ in range(task.n_states)]
        self.promises = self._promises()
        self.moves = self._moves()
        self.masked = 0
        self.violations = 0
        self.env_steps = 0
        self.steps: list[int] = []
        self.returns: list[float] = []
        self.outcomes: list[int] = []

    def _promises(self) -> Promises | None:
        """Start with the promise of the start; None where there is nothing to promise: then this is plain."""
        if self.settings.method != "shaped" or not any(value > 0 for value in self.reward):
            return None
        found = Promises(self.reward, self.task.start)
        self.q[self.task.start] = [found.claims[self.task.start]] * self.task.n_actions
        return found

    def _moves(self) -> list[list[Move]]:
        table = moves(self.task.transitions, self.endings, self.settings.step_cost, self.task.payoffs)
        if self.promises is not None:
            tried = set(self.promises.tried)
            table = [
                [move if (state, action) in tried else (*move[:2], UNTRIED) for action, move in enumerate(row)]
                for state, row in enumerate(table)
            ]
        return table

    @cached_property
    def _ways_in(self) -> list[list[tuple[int, int]]]:
        """The pairs of state and action that lead to each state."""
        found: list[list[tuple[int, int]]] = [[] for _ in self.task.transitions]
        for state, row in enumerate(self.task.transitions):
            for action, after in enumerate(row):
                found[after].append((state, action))
        return found

    def _close(self, dead: int) -> None:
        """Let the moves into a state pay and end as a violation; many states may die, so only these are touched."""
        pays = base_reward(VIOLATION, self.settings.step_cost)
        if self.task.payoffs:
            pays += self.task.payoffs[dead]
        for state, action in self._ways_in[dead]:
            untried = self.moves[state][action][2] == UNTRIED
            self.moves[state][action] = (dead, pays, UNTRIED if untried else VIOLATION)

    def discover(self, state: int, action: int) -> int:
        """Look at what an action does that is taken for the first time; return how the episode stands then.

        A state reached for the first time gets its promise, and promises that this action was the last hope
        of are corrected. Their values change by the same amount: shaped values, which leave the potential
        out, stay as they were.
        """
        after, reward, _ = self.moves[state][action]
        ending = self.endings[after]
        self.moves[state][action] = (after, reward, ending)
        promises = self.promises
        assert promises is not None
        promises.note(state, action, after)
        if ending == RUNS:
            self._add(after, promises.reach(after, promises.claims[state]))
        self._correct([state])
        return ending

    def recall(self, tried: Sequence[tuple[int, int]], claims: Sequence[float]) -> None:
        """Go back to what promises a checkpoint holds; values are to be set after this."""
        if self.promises is None:
            return
        for state, action in tried:
            after = self.moves[state][action][0]
            self.promises.note(state, action, after)
            if self.task.endings[after] == RUNS:
                self.promises.reach(after, 0.0)
        self.promises.claims[:] = claims
        self.moves[:] = self._moves()

    def _add(self, state: int, amount: float) -> None:
        row = self.q[state]
        for action in self.choices[state]:
            row[action] += amount

    def _correct(self, states: Iterable[int]) -> None:
        if self.promises is not None:
            for state, loss in self.promises.correct(states, self.moves, self.choices, self.settings.gamma):
                self._add(state, -loss)

    def forbid(self, pairs: Iterable[tuple[int, int]]) -> None:
        """Mask pairs of state and action; a state without an action left counts as violating itself."""
        for state, action in pairs:
            if action not in self.choices[state]:
                continue
            self.choices[state].remove(action)
            self.q[state][action] = -inf
            self.masked += 1
            affected = [state]
            if not self.choices[state] and self.endings[state] == RUNS:
                self.endings[state] = VIOLATION
                self._close(state)
                affected += self.promises.before[state] if self.promises is not None else ()
            self._correct(affected)

    def record(self, state: int, action: int, ending: int, steps: int, total: float) -> None:
        """Write an episode, which ended with `action` in `state`, into the log and the mask."""
        self.steps.append(steps)
        self.returns.append(total)
        self.outcomes.append(ending)
        self.env_steps += steps
        if ending == VIOLATION:
            self.violations += 1
        if ending in (VIOLATION, AVOIDED) and self.settings.mask:
            self.forbid([(state, action)])

    def skip(self, count: int) -> None:
        """Log `count` episodes that are over before their first step, since the start ends them."""
        for _ in range(count):
            self.steps.append(0)
            self.returns.append(0.0)
            self.outcomes.append(self.endings[self.task.start])


def run_chunk(learner: Learner, index: int) -> None:
    """Train for the next `CHUNK` episodes, or for those that are left.

    Not in the paper: random numbers depend on the seed and the number of the chunk alone, so that a resumed
    run repeats an uninterrupted one bit for bit (and on `Task.stream`, so that tasks of one run differ).

    Args:    learner: changed in place. index: the number of the chunk, from 0.
    """
    settings = learner.settings
    count = min(CHUNK, settings.episodes - index * CHUNK)
    random = np.random.default_rng([settings.seed, index, *learner.task.stream])
    if settings.method == "paper":
        run_paper_episodes(learner, count, random)
    else:
        run_episodes(learner, count, random)


def run_episodes(learner: Learner, count: int, random: np.random.Generator) -> None:
    """Train for `count` episodes on the base reward, with the potential in the values (see `promises`).

    Paper: Algorithm 2, with the reward of decision 7 instead of the printed one (see `shaping`). The action
    is the best one, the lowest on ties, or with probability epsilon any allowed one. Ends terminate;
    the step limit does not: the value of the state reached there is used.
    """
    q, table, choices, start = learner.q, learner.moves, learner.choices, learner.task.start
    gamma, alpha, epsilon = learner.settings.gamma, learner.settings.alpha, learner.settings.epsilon
    limit, cost = learner.settings.max_steps, learner.settings.step_cost
    state, steps, left = start, 0, count
    while left:
        if learner.endings[start] != RUNS:
            return learner.skip(left)
        row = q[state]
        best = max(row)
        for uniform in random.random(_BLOCK).tolist():
            if uniform < epsilon:
                free = choices[state]
                # uniform / epsilon is uniform in [0, 1); its product with a small count stays below the count
                action = free[int(uniform / epsilon * len(free))]
            else:
                action = row.index(best)
            after, reward, ending = table[state][action]
            steps += 1
            old = row[action]  # holds the potential that the state had on arrival, whatever a first try corrects
            if ending == UNTRIED:
                ending = learner.discover(state, action)
            if ending:
                row[action] += alpha * (reward - old)
            else:
                ahead = q[after]
                value = max(ahead)
                row[action] += alpha * (reward + gamma * value - old)
                if steps < limit:
                    # the maximum of the next row is known already, unless this very row has just changed
                    best = value if after != state else max(row)
                    state, row = after, ahead
                    continue
                ending = LIMIT
            learner.record(state, action, ending, steps, base_reward(ending, cost * steps))
            state, steps, left = start, 0, left - 1
            if not left or learner.endings[start] != RUNS:
                break
            row = q[state]
            best = max(row)
    return None


def feedback(lows: Sequence[float]) -> float:
    """Add up the robustness of the partial policy over the hard requirements.

    Paper: section 3.2 and Algorithm 2, line 11. An infinite robustness (a map without obstacles), and
    one beyond `LARGEST_ROBUSTNESS`, counts as its tanh, 1 or -1, so that returns stay finite.

    Args:    lows: for each hard requirement the smallest robustness of its condition so far.
    Returns: the sum.
    """
    if all(-LARGEST_ROBUSTNESS < low < LARGEST_ROBUSTNESS for low in lows):
        return fsum(lows)
    return fsum(low if abs(low) < LARGEST_ROBUSTNESS else (1.0 if low > 0 else -1.0) for low in lows)


def run_paper_episodes(learner: Learner, count: int, random: np.random.Generator) -> None:
    """Train for `count` episodes with the paper's reward: R(s') plus the robustness of the partial policy.

    Paper: Algorithm 2 to the letter, R_fb constant, no shaping, no mask; only a step limit is added. The
    robustness of `always` at sample 0 over a prefix is a running minimum: constant work a step.
    """
    q, transitions, endings, start = learner.q, learner.task.transitions, learner.endings, learner.task.start
    settings, robustness, reward = learner.settings, learner.task.robustness, learner.reward
    numbers: list[float] = []
    for _ in range(count):
        state, steps, total, ending, action = start, 0, 0.0, endings[start], 0
        lows = list(robustness[start])
        while ending == RUNS:
            if not numbers:
                numbers = random.random(_BLOCK).tolist()
            uniform = numbers.pop()
            row = q[state]
            explore = uniform < settings.epsilon
            action = int(uniform / settings.epsilon * len(row)) if explore else row.index(max(row))
            after = transitions[state][action]
            lows = [min(low, now) for low, now in zip(lows, robustness[after], strict=True)]
            gained = reward[after] + feedback(lows)
            row[action] += settings.alpha * (gained + settings.gamma * max(q[after]) - row[action])
            total += gained
            steps += 1
            ending = endings[after]
            if ending == RUNS and steps == settings.max_steps:
                ending = LIMIT
            elif ending == RUNS:
                state = after
        learner.record(state, action, ending, steps, total)
