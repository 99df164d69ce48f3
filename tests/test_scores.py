"""Scores: every equation by hand, and the labels and ranks of whole sets of demonstrations."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.errors import DataError, UsageError
from stlspec.scores import (
    LABELS,
    bounded_robustness,
    demonstration_label,
    demonstration_reward,
    number,
    ranks,
    score,
    value_text,
)
from stlspec.semantics.evaluation import Verdict

SPEC = """
signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
soft fast depends on avoid, reach: eventually[0, 2] (d_goal < 1)
"""
GRID = api.compile(SPEC)
# the softmax of 3, 2, 1, by the definition
TOTAL = math.exp(3) + math.exp(2) + math.exp(1)
WEIGHTS = [math.exp(k) / TOTAL for k in (3, 2, 1)]
HOLDS, FAILS, OPEN = Verdict.SATISFIED, Verdict.VIOLATED, Verdict.UNDECIDED


def demo(name, d_obs, d_goal, **more):
    return make_demonstration(name, {"d_obs": d_obs, "d_goal": d_goal}, **more)


GOOD = demo("good", [1, 2, 1], [2, 1, 0])
SLOW = demo("slow", [1, 2, 1, 1], [3, 2, 1, 0])
LOST = demo("lost", [1, 1, 1], [2, 2, 2])
BAD = demo("bad", [1, 0, 1], [2, 1, 0])


@pytest.mark.parametrize(
    ("robustness", "bound", "scale", "expected"),
    [
        (0.0, "tanh", 1.0, 0.0),
        (1.0, "tanh", 1.0, 0.7615941559557649),
        (-3.0, "tanh", 3.0, -0.7615941559557649),
        (math.inf, "tanh", 5.0, 1.0),
        (-math.inf, "tanh", 5.0, -1.0),
        (0.5, "linear", 1.0, 0.5),
        (0.5, "linear", 2.0, 0.25),
        (7.0, "linear", 2.0, 1.0),
        (-math.inf, "linear", 2.0, -1.0),
        (7.0, "none", 1.0, 7.0),
        (7.0, "none", 2.0, 3.5),
    ],
)
def test_robustness_is_bounded_by_hand(robustness, bound, scale, expected):
    assert bounded_robustness(robustness, bound, scale) == expected


@given(st.floats(allow_nan=False), st.floats(allow_nan=False), st.sampled_from(["tanh", "linear"]))
def test_bounding_keeps_order_and_sign_and_stays_in_range(a, b, bound):
    low, high = sorted((bounded_robustness(a, bound, 2.0), bounded_robustness(b, bound, 2.0)))
    assert -1 <= low <= high <= 1
    assert (bounded_robustness(min(a, b), bound, 2.0), bounded_robustness(max(a, b), bound, 2.0)) == (low, high)
    assert bounded_robustness(-a, bound, 2.0) == -bounded_robustness(a, bound, 2.0)


def test_the_reward_is_the_weighted_sum():
    assert demonstration_reward([0.5, 0.25, 0.25], [1.0, -1.0, 0.5]) == 0.375
    assert demonstration_reward([], []) == 0.0


@pytest.mark.parametrize(
    ("hard", "soft", "expected"),
    [
        ([HOLDS], [HOLDS], "good"),
        ([], [], "good"),
        ([HOLDS], [HOLDS, FAILS], "incomplete"),
        ([HOLDS, FAILS], [HOLDS], "bad"),
        ([FAILS], [FAILS], "bad"),
        ([FAILS], [OPEN], None),
        ([OPEN], [HOLDS], None),
    ],
)
def test_labels_go_by_verdicts(hard, soft, expected):
    assert demonstration_label(hard, soft) == expected


@pytest.mark.parametrize(
    ("labels", "rewards", "expected"),
    [
        (["good", "bad"], [0.1, 0.9], [2, 1]),
        (["good", "good", "good"], [0.2, 0.2 + 9e-10, 0.2 + 2e-9], [1, 1, 2]),
        (["bad", "incomplete", "good"], [0.0, 0.0, 0.0], [1, 2, 3]),
        (["good", None, "bad"], [0.5, 9.0, 0.5], [2, None, 1]),
        (["good", "good", "bad", "incomplete", "incomplete"], [0.255, 0.255, -0.25, -0.33, 0.11], [4, 4, 1, 2, 3]),
        ([], [], []),
    ],
)
def test_ranks_are_dense_with_the_worst_first(labels, rewards, expected):
    assert ranks(labels, rewards) == expected


def test_a_group_is_measured_from_its_first():
    """Steps of 0.6e-9: the second is within 1e-9 of the first, the third is not and opens a group."""
    assert ranks(["good"] * 4, [0.0, 0.6e-9, 1.2e-9, 1.8e-9]) == [1, 1, 2, 2]


SOME = st.lists(st.tuples(st.sampled_from(LABELS), st.integers(-5, 5)), max_size=8)


@given(SOME)
def test_a_better_label_or_reward_never_ranks_lower(rows):
    found = ranks([label for label, _ in rows], [float(reward) for _, reward in rows])
    for (a, x), i in zip(rows, found, strict=True):
        for (b, y), j in zip(rows, found, strict=True):
            assert (i < j) == ((LABELS.index(a), x) < (LABELS.index(b), y))
    assert sorted(set(found)) == list(range(1, len(set(found)) + 1))


def test_a_set_of_demonstrations_by_hand():
    """rho: good (0, 1, 1), slow (0, 1, 0), lost (0, -1, -1), bad (-1, 1, 1); tanh(1) = .76159."""
    ranking = score(GRID, [GOOD, SLOW, LOST, BAD])
    t = math.tanh(1)
    by_hand = [
        t * (WEIGHTS[1] + WEIGHTS[2]), t * WEIGHTS[1], -t * (WEIGHTS[1] + WEIGHTS[2]),
        t * (WEIGHTS[1] + WEIGHTS[2] - WEIGHTS[0]),
    ]  # fmt: skip
    found = ranking.demonstrations
    assert [d.name for d in found] == ["good", "slow", "lost", "bad"]
    assert [d.label for d in found] == ["good", "incomplete", "incomplete", "bad"]
    assert [d.reward for d in found] == pytest.approx(by_hand)
    assert [d.rank for d in found] == [4, 3, 2, 1]


def test_a_violation_is_explained_with_its_sample():
    bad = score(GRID, [BAD]).demonstrations[0].requirements
    assert bad["avoid"].reason == "avoid fails at sample 1: d_obs = 0, needs >= 1"
    assert bad["reach"].reason == ""


def test_states_are_scored_through_the_environment():
    world = make_environment("stlspec/GridWorld-v0", None, ("S.G", ".#."))
    demos = [make_demonstration("a", states=[[0, 0], [0, 1], [0, 2]]), make_demonstration("b", states=[0, 3, 4, 5, 2])]
    assert [d.label for d in score(GRID, demos, world).demonstrations] == ["good", "bad"]


def test_a_vacuous_requirement_is_worth_0():
    """At sample 3 of 3 there is nothing left of [5, 6]: vacuously violated, and no term of the sum."""
    bundle = api.compile("signal x\nhard a: always (x > 0)\nsoft b depends on a: eventually[5, 6] (x > 9)")
    (found,) = score(bundle, [make_demonstration("d", {"x": [1, 2, 3]})]).demonstrations
    assert found.requirements["b"].bounded == 0.0
    assert found.requirements["b"].result.vacuous
    assert found.label == "incomplete"
    assert found.reward == pytest.approx(math.tanh(1) * math.exp(2) / (math.exp(2) + math.exp(1)))
    assert found.requirements["b"].reason.startswith("b fails:")


@pytest.mark.parametrize("value", [math.inf, -math.inf, 1e200])
def test_an_infinite_term_without_a_bound_is_refused(value):
    bundle = api.compile("signal x\nhard a bound none: always (x > 0)")
    with pytest.raises(DataError) as caught:
        score(bundle, [make_demonstration("d", {"x": [value]})])
    assert caught.value.diagnostics[0].code == "D860"
    assert "'a'" in caught.value.diagnostics[0].message
    assert score(api.compile("signal x\nhard a bound none: always (x > 0)"), [make_demonstration("d", {"x": [4]})])


def test_asking_about_one_sample_leaves_out_label_reward_and_rank():
    document = score(GRID, [BAD], at=-1).to_json()
    (found,) = document["demonstrations"]
    assert set(found) == {"name", "requirements"}
    assert found["requirements"]["avoid"]["verdict"] == "satisfied"
    assert found["requirements"]["reach"]["robustness"] == 1.0


def test_a_sample_that_does_not_exist_is_refused():
    with pytest.raises(UsageError):
        score(GRID, [BAD], at=17)


def test_strict_refuses_a_trace_shorter_than_the_horizon():
    with pytest.raises(DataError):
        score(GRID, [demo("short", [1], [0])], end="strict")


def test_nan_is_refused_or_held_as_asked():
    broken = demo("broken", [1, math.nan, 1], [2, 1, 0])
    with pytest.raises(DataError):
        score(GRID, [broken])
    assert score(GRID, [broken], on_nan="hold").demonstrations[0].label == "good"


def test_the_document_has_the_agreed_keys():
    document = json.loads(json.dumps(score(GRID, [GOOD, BAD]).to_json(), allow_nan=False))
    assert document["schema"] == "stlspec.score/1"
    assert document["requirements"][0] == {
        "name": "avoid", "strength": "hard", "weight": pytest.approx(WEIGHTS[0]), "raw_weight": 3,
    }  # fmt: skip
    assert list(document["demonstrations"][1]) == ["name", "label", "reward", "rank", "requirements"]
    assert document["demonstrations"][1]["requirements"]["avoid"] == {
        "robustness": -1.0, "bounded": pytest.approx(-math.tanh(1)), "verdict": "violated", "vacuous": False,
        "witness": {"sample": 1, "time": 1.0},
    }  # fmt: skip


def test_infinities_are_words():
    assert [number(x) for x in (1.5, math.inf, -math.inf)] == [1.5, "inf", "-inf"]


def test_no_demonstrations_give_an_empty_ranking():
    assert score(GRID, []).demonstrations == ()


def test_a_ranking_and_its_rows_show_themselves_in_a_notebook() -> None:
    ranking = score(GRID, [demo("first <i>", [2, 1], [1, 0]), demo("second", [0, 1], [2, 1])])
    shown = ranking._repr_html_()
    assert shown.index("first &lt;i&gt;") < shown.index("second")
    assert "<i>" not in shown
    assert [ranking.demonstrations[k].name for k in ranking.best_first()] == ["first <i>", "second"]
    assert ranking.demonstrations[1]._repr_html_().count("<svg") == 3


def test_a_value_in_a_table_says_when_it_is_open_or_vacuous() -> None:
    (row,) = score(GRID, [demo("open", [2, 1], [1, 1])], end="interval").demonstrations
    assert value_text(row.requirements["avoid"].result) == "[-∞, 0]"
    late = api.compile("signal x\nhard late: always[5, 6] (x > 0)\n")
    (row,) = score(late, [make_demonstration("short", {"x": [1.0]})]).demonstrations
    assert value_text(row.requirements["late"].result) == "∞ ∅"
