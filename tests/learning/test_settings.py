"""The options of the learner and their defaults."""

import math

import pytest

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.bins import Bins
from stlspec.envs.model import Environment
from stlspec.errors import UsageError
from stlspec.learning.settings import default_episodes, make_settings, needed_steps

GIVEN = {
    "method": "shaped", "episodes": None, "seed": 0, "max_steps": None, "gamma": 0.99, "alpha": 0.1,
    "epsilon": 0.4, "step_cost": 0.01, "mask": True,
}  # fmt: skip


@pytest.mark.parametrize(("rows", "columns", "expected"), [(5, 5, 3000), (4, 7, 5000), (8, 2, 10_000)])
def test_the_longer_side_of_a_map_decides_how_long_to_train(rows, columns, expected):
    assert default_episodes(Environment("x", map=("." * columns,) * rows)) == expected


def test_without_a_map_the_default_is_5000_episodes():
    assert default_episodes(Environment("x")) == 5000


def test_the_step_limit_is_the_environment_s_own_or_four_times_the_states():
    assert make_settings(Environment("x", n_states=7, max_steps=100), **GIVEN).max_steps == 100
    assert make_settings(Environment("x", n_states=7), **GIVEN).max_steps == 28


@pytest.mark.parametrize(("counts", "expected"), [((48,), 192), ((50, 50), 1000)])
def test_the_step_limit_between_bins_is_four_times_their_number_up_to_a_thousand(counts, expected):
    bins = Bins((0.0,) * len(counts), (1.0,) * len(counts), counts)
    assert make_settings(Environment("x", bins=bins), **GIVEN).max_steps == expected


def test_the_step_limit_is_never_below_what_is_needed_but_where_the_environment_has_one():
    assert make_settings(Environment("x", n_states=7), needed=40, **GIVEN).max_steps == 40
    assert make_settings(Environment("x", n_states=7), needed=20, **GIVEN).max_steps == 28
    assert make_settings(Environment("x", n_states=7, max_steps=10), needed=40, **GIVEN).max_steps == 10
    assert make_settings(Environment("x", n_states=7), needed=40, **{**GIVEN, "max_steps": 5}).max_steps == 5


@pytest.mark.parametrize(
    ("time", "formula", "lengths", "expected"),
    [
        ("step", "eventually (x > 0)", (14, 3), 26),
        ("step", "eventually[0, 30] (x > 0)", (14,), 30),
        ("step", "eventually (x > 0)", (), 0),
        ("100 ms", "eventually[0 s, 3 s] (x > 0)", (), 30),
        ("step", "always[0, 1000000] (x > 0)", (), 10_000),
    ],
)
def test_an_episode_needs_twice_the_longest_demonstration_and_what_the_spec_looks_ahead(
    time, formula, lengths, expected
):
    bundle = api.compile(f"time {time}\nsignal x\nsoft r: {formula}")
    assert needed_steps(bundle, [make_demonstration("d", {"x": [0.0] * n}) for n in lengths]) == expected


def test_the_method_of_the_paper_has_no_mask():
    assert not make_settings(Environment("x"), **{**GIVEN, "method": "paper"}).mask
    assert make_settings(Environment("x"), **GIVEN).mask


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("method", "fast"), ("episodes", 0), ("episodes", 2.5), ("episodes", True), ("seed", -1),
        ("max_steps", 0), ("gamma", 1.01), ("gamma", math.nan), ("alpha", 0), ("alpha", "x"),
        ("epsilon", -0.1), ("step_cost", math.inf), ("step_cost", -1),
    ],
)  # fmt: skip
def test_an_option_out_of_range_is_named_with_its_range(option, value):
    with pytest.raises(UsageError) as caught:
        make_settings(Environment("x"), **{**GIVEN, option: value})
    (found,) = caught.value.diagnostics
    assert found.code == "D871"
    assert option.replace("_", "-") in found.message
