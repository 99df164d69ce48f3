"""Rows and results with made-up figures, from which tables and verdicts can be worked out by hand."""

from dataclasses import asdict, replace
from types import SimpleNamespace

import pytest

from stlspec.paper.budgets import Budget
from stlspec.paper.journal import Record
from stlspec.paper.runs import Row

ROW = Row(
    seed=0, success=True, hard=True, reached=True, probability=None, path=8, late=0, episodes=100, env_steps=1000,
    to_success=200, episodes_to_success=25, violations=4, prefilled=1, farming=False, goals=0.9, seconds=0.5,
    curve=(10.0, 8.0),
)  # fmt: skip
TINY = Budget("tiny", 2, ((50, 1), (75, 1), (100, 1)), 2, 20, 3, 3, 1.0)


def rows(*to_success, **fields):
    """One row for each number of steps; None = never, which is no success."""
    return [
        replace(ROW, seed=k, to_success=steps, success=steps is not None, **fields)
        for k, steps in enumerate(to_success)
    ]


def as_json(by_group):
    return {g: {m: [asdict(row) for row in found] for m, found in by.items()} for g, by in by_group.items()}


def record(name, result, seconds=60.0):
    machine = {"processors": 2, "python": "3.11.0", "stlspec": "0.1.0"}
    return Record(name, TINY.to_json(), seconds, (0.5, 1.5), machine, result)


TABLE_1 = {
    "ours": {
        "demonstrations": 3, "samples": 27, "states": 25, "seconds": 0.002, "valued": 16, "cold": 0.9,
        "correlation": 0.5,
    },
    "irl": {"skipped": "there is no network", "seconds": None, "extrapolated": False, "reward": None},
    "truth": [1.0] * 25,
}  # fmt: skip
IRL = {
    "demonstrations": 70, "seconds": 4.0, "extrapolated": False, "note": "converged after 10 gradient steps",
    "reward": [0.0] * 25, "correlation": -0.25, "skipped": None, "iterations": 1000, "horizon": 16,
}  # fmt: skip


@pytest.fixture
def made():
    """The helpers of this file, for test modules, which cannot import it."""
    return SimpleNamespace(row=ROW, tiny=TINY, rows=rows, as_json=as_json, record=record, table_1=TABLE_1, irl=IRL)
