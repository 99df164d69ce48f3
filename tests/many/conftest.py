"""A spec and a handful of files that the tests of this folder score."""

import json

import numpy as np
import pytest

from stlspec import api
from stlspec.many.work import job_of

SPEC = "spec s\nsignal x\nsignal y\nhard up: always (x > -2)\nsoft far depends on up: eventually[0, 5] (y > 1)\n"


@pytest.fixture
def job():
    return job_of(api.compile(SPEC), None)


@pytest.fixture
def paths(tmp_path):
    rng = np.random.default_rng(4)
    made = []
    for number in range(9):
        rows = [{"signals": {"x": rng.normal(size=12).tolist(), "y": rng.normal(size=12).tolist()}} for _ in range(3)]
        path = tmp_path / f"demo{number}.jsonl"
        path.write_text("".join(json.dumps(row) + "\n" for row in rows))
        made.append(str(path))
    return made
