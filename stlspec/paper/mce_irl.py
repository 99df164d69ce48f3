"""Train MCE-IRL of the library imitation on one task, and time it: a script for an environment of its own.

In: the path of a problem (.npz, see `irl`) and the path of the answer. Out: the answer, JSON. It imports nothing
of stlspec, for stlspec is not there, and the libraries late: they take seconds to load, and whoever tests the rest
does not have them. Standard input is held open by the caller: when it closes, the caller is gone, and so is this.
"""

import json
import os
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

SCHEMA = "stlspec.mce-irl/1"
LIBRARIES = ("imitation", "seals", "torch", "numpy")

Floats = npt.NDArray[np.float64]


class Sparse:
    """Transitions that act like a (n_states, n_actions, n_states) array where imitation uses one.

    It multiplies from the left by a vector of values, and takes the slice of an action to be multiplied from the
    right: `T @ v` and `e @ T[:, a, :]`. Entries are sorted by state, then action; each pair has at least one.
    """

    def __init__(self, problem: Mapping[str, Any]) -> None:
        n_states, n_actions = int(problem["n_states"]), int(problem["n_actions"])
        self.shape = (n_states, n_actions, n_states)
        self.afters, self.probabilities = problem["afters"], problem["probabilities"]
        pairs = problem["states"] * n_actions + problem["actions"]
        self.firsts = np.searchsorted(pairs, np.arange(n_states * n_actions))
        own = [problem["actions"] == action for action in range(n_actions)]
        self.columns = [_Column(problem["states"][k], self.afters[k], self.probabilities[k], n_states) for k in own]

    def __matmul__(self, values: Floats) -> Floats:
        found: Floats = np.add.reduceat(self.probabilities * values[self.afters], self.firsts)
        return found.reshape(self.shape[:2])

    def __getitem__(self, place: tuple[slice, int, slice]) -> "_Column":
        return self.columns[place[1]]


class _Column:
    """The transitions of one action."""

    __array_ufunc__ = None  # an array on the left hands over to __rmatmul__

    def __init__(self, states: Any, afters: Any, probabilities: Any, n_states: int) -> None:
        self.states, self.afters, self.probabilities, self.n_states = states, afters, probabilities, n_states

    def __rmatmul__(self, weights: Floats) -> Floats:
        flows = weights[self.states] * self.probabilities
        return np.bincount(self.afters, weights=flows, minlength=self.n_states).astype(np.float64)


def dense(problem: Mapping[str, Any]) -> Floats:
    """Return the transitions as the array that imitation documents."""
    n_states, n_actions = int(problem["n_states"]), int(problem["n_actions"])
    table = np.zeros((n_states, n_actions, n_states))
    table[problem["states"], problem["actions"], problem["afters"]] = problem["probabilities"]
    return table


class OutOfTimeError(Exception):
    """The time limit was reached between two gradient steps."""


class Watch:
    """Takes the time of every gradient step, and stops after the step at which a limit is reached."""

    def __init__(self, step: Any, limit: float) -> None:
        self.step, self.limit = step, limit
        self.seconds: list[float] = []
        self.visits: Any = None
        self.began = time.perf_counter()

    def __call__(self, observations: Any) -> tuple[Any, Any]:
        """Take a step, as `MCEIRL._train_step`."""
        before = time.perf_counter()
        if self.seconds and before - self.began > self.limit:
            raise OutOfTimeError
        reward, self.visits = self.step(observations)
        self.seconds.append(time.perf_counter() - before)
        return reward, self.visits


def train(problem: Mapping[str, Any]) -> dict[str, Any]:
    """Train with the library's defaults: Adam, learning rate 0.01, both of its convergence criteria.

    Observations are one-hot and the reward is linear in them: a number for every state, with which the problem is
    convex. That is the most a state reward can express, and the fastest.
    """
    import torch
    from imitation.algorithms.mce_irl import MCEIRL
    from imitation.rewards.reward_nets import BasicRewardNet
    from seals.base_envs import TabularModelPOMDP

    # the first step of any optimiser loads more of torch, for seconds: that is no time of MCE-IRL's
    warm = torch.nn.Linear(1, 1)
    warm(torch.ones(1)).backward()
    torch.optim.Adam(warm.parameters()).step()
    torch.manual_seed(0)
    n_states = int(problem["n_states"])
    table = Sparse(problem) if problem["sparse"] else dense(problem)
    world = TabularModelPOMDP(
        transition_matrix=table, observation_matrix=np.eye(n_states, dtype=np.float32),
        reward_matrix=np.zeros(n_states), horizon=int(problem["horizon"]), initial_state_dist=problem["starts"],
    )  # fmt: skip
    began = time.perf_counter()
    net = BasicRewardNet(world.observation_space, world.action_space, use_action=False, hid_sizes=())
    learner = MCEIRL(problem["visits"], world, net, rng=np.random.default_rng(0), log_interval=None)
    watch = learner._train_step = Watch(learner._train_step, float(problem["seconds"]))
    ended = "steps"
    try:
        learner.train(max_iter=int(problem["steps"]))
    except OutOfTimeError:
        ended = "seconds"
    seconds = time.perf_counter() - began
    gap = float(np.max(np.abs(watch.visits - problem["visits"])))
    gradient = sum(float((p.grad**2).sum()) for p in net.parameters()) ** 0.5
    if ended == "steps" and (gap <= learner.linf_eps or gradient <= learner.grad_l2_eps):
        ended = "converged"
    with torch.no_grad():
        reward = net(torch.as_tensor(world.observation_matrix), None, None, None).tolist()
    return {
        "versions": {name: version(name) for name in LIBRARIES},
        "steps": len(watch.seconds), "seconds": seconds, "step_seconds": float(np.median(watch.seconds)),
        "gradient": gradient, "gap": gap, "ended": ended, "reward": reward,
    }  # fmt: skip


def _end_with_caller() -> None:
    # not sys.stdin, whose lock a thread that still reads would hold when the interpreter ends
    while os.read(0, 1):
        pass
    os._exit(1)


def main(arguments: Sequence[str]) -> int:
    """Solve the problem at the first path and write the answer to the second one."""
    threading.Thread(target=_end_with_caller, daemon=True).start()
    with np.load(arguments[0], allow_pickle=False) as file:
        problem = dict(file)
    answer = {"schema": SCHEMA, **train(problem)}
    Path(arguments[1]).write_text(json.dumps(answer, allow_nan=False))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
