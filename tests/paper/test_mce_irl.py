"""The script that runs beside imitation: its sparse tables act like dense ones, its clock stops, it dies with us.

The library is not here; a stand-in with the same calls takes its place. `tests/paper/baseline.py` runs the real one.
"""

import json
import os
import subprocess
import sys
import time
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from stlspec.paper import mce_irl
from stlspec.paper.irl import SCRIPT, read_answer
from stlspec.paper.mce_irl import OutOfTimeError, Sparse, Watch, dense


@pytest.fixture
def problem():
    """Five states, three actions, two outcomes each, all by chance but sorted as `tabular` sorts."""
    draw = np.random.default_rng(1)
    table = np.zeros((5, 3, 5))
    for row in table.reshape(15, 5):
        row[draw.choice(5, 2, replace=False)] = draw.dirichlet([1, 1])
    states, actions, afters = np.nonzero(table)
    return {
        "n_states": 5, "n_actions": 3, "states": states, "actions": actions, "afters": afters,
        "probabilities": table[states, actions, afters], "starts": np.eye(5)[0], "visits": np.ones(5),
        "horizon": 4, "steps": 10, "seconds": 9.0, "sparse": False, "table": table,
    }  # fmt: skip


def test_dense_tables_hold_every_entry(problem):
    assert np.array_equal(dense(problem), problem["table"])


def test_sparse_tables_multiply_like_dense_ones_from_both_sides(problem):
    table, sparse, vector = problem["table"], Sparse(problem), np.arange(5) + 0.5
    assert sparse.shape == table.shape
    assert sparse @ vector == pytest.approx(table @ vector)
    for action in range(3):
        assert vector @ sparse[:, action, :] == pytest.approx(vector @ table[:, action, :])


def test_the_clock_stops_between_steps_and_not_before_the_first():
    watch = Watch(lambda _: ("reward", "visits"), limit=-1.0)
    assert watch(None) == ("reward", "visits")
    with pytest.raises(OutOfTimeError):
        watch(None)
    assert len(watch.seconds) == 1


class Tensor(np.ndarray):
    def backward(self):
        pass


def stand_in(monkeypatch, converges_at):
    """Put a library with the calls of imitation in place: its gap halves with every step."""

    class Learner:
        linf_eps, grad_l2_eps = 1e-3, 1e-4

        def __init__(self, visits, world, net, rng, log_interval):
            assert world["horizon"] == 4
            self.wanted, self.count = visits, 0

        def _train_step(self, observations):
            self.count += 1
            time.sleep(0.02)
            return None, self.wanted + (0.0 if self.count == converges_at else 2.0**-self.count)

        def train(self, max_iter):
            for _ in range(max_iter):
                visits = self._train_step(None)[1]
                if np.abs(visits - self.wanted).max() <= self.linf_eps:
                    break

    class World(dict):
        observation_space = action_space = None
        observation_matrix = np.eye(5)

    class Net:
        def parameters(self):
            return [SimpleNamespace(grad=np.array([3.0, 4.0]))]

        def __call__(self, observations, *_):
            return np.arange(5.0)

    class Quiet:
        def __enter__(self):
            return None

        def __exit__(self, *_):
            return None

    torch = SimpleNamespace(
        manual_seed=lambda _: None, as_tensor=lambda x: x, no_grad=Quiet, ones=lambda n: n,
        nn=SimpleNamespace(Linear=lambda *_: SimpleNamespace(parameters=list, __call__=None)),
        optim=SimpleNamespace(Adam=lambda _: SimpleNamespace(step=lambda: None)),
    )  # fmt: skip
    torch.nn.Linear = type(
        "Linear", (), {"__init__": lambda *_: None, "parameters": lambda _: [],
                       "__call__": lambda *_: np.zeros(1).view(Tensor)}
    )  # fmt: skip
    modules = {
        "torch": torch, "imitation": ModuleType("imitation"), "seals": ModuleType("seals"),
        "imitation.algorithms": ModuleType("a"), "imitation.rewards": ModuleType("r"),
        "imitation.algorithms.mce_irl": SimpleNamespace(MCEIRL=Learner),
        "imitation.rewards.reward_nets": SimpleNamespace(BasicRewardNet=lambda *_, **__: Net()),
        "seals.base_envs": SimpleNamespace(TabularModelPOMDP=lambda **fields: World(fields)),
    }  # fmt: skip
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(mce_irl, "version", lambda name: f"{name} 1")
    monkeypatch.setattr(mce_irl, "_end_with_caller", lambda: None)


@pytest.mark.parametrize(
    ("converges_at", "changes", "ended", "steps"),
    [(None, {}, "converged", 10), (3, {}, "converged", 3), (None, {"steps": 4}, "steps", 4),
     (None, {"seconds": 0.03}, "seconds", 2)],
)  # fmt: skip
def test_a_problem_becomes_an_answer_that_stlspec_reads(
    problem, tmp_path, monkeypatch, converges_at, changes, ended, steps
):
    stand_in(monkeypatch, converges_at)
    np.savez(tmp_path / "problem.npz", **(problem | changes))
    answer = tmp_path / "answer.json"
    assert mce_irl.main([str(tmp_path / "problem.npz"), str(answer)]) == 0
    found = read_answer(answer, 5, 10)
    assert (found.ended, found.steps, found.gradient) == (ended, steps, 5.0)
    assert found.reward == (0.0, 1.0, 2.0, 3.0, 4.0)
    assert found.seconds >= found.steps * found.step_seconds * 0.5 > 0
    assert dict(found.versions)["imitation"] == "imitation 1"
    assert json.loads(answer.read_text())["schema"] == mce_irl.SCHEMA


@pytest.mark.skipif(os.name == "nt", reason="named pipes")
def test_the_script_ends_when_its_caller_is_gone(tmp_path):
    waiting = tmp_path / "problem.npz"  # reading it blocks: nobody writes to the pipe
    os.mkfifo(waiting)
    script = subprocess.Popen([sys.executable, "-I", SCRIPT, waiting, tmp_path / "answer.json"], stdin=subprocess.PIPE)
    try:
        time.sleep(0.5)
        assert script.poll() is None
        script.stdin.close()
        assert script.wait(20) == 1
    finally:
        script.kill()
        script.wait()
