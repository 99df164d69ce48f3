"""Learner states: those of the environment, times what hard requirements remember."""

import random

import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.errors import UsageError
from stlspec.learning import product
from stlspec.learning.product import make_product, split_hard, step_conditions

HEAD = "".join(f"signal {name}\n" for name in ("d_obs", "d_goal", "row", "col", "in_a: bool", "in_b: bool"))
ROWS = ("S.#.", "a..b", "..bG")
WORLD = make_environment("stlspec/GridWorld-v0", None, ROWS)


def compiled(text):
    return api.compile(HEAD + text)


def product_of(formula, world=WORLD, **fields):
    return make_product(compiled(f"hard h: {formula}"), world, world.transitions, **{"longest": 50, **fields})


@pytest.mark.parametrize(
    ("formula", "count"),
    [
        ("always (d_obs >= 1)", 1),
        ("always[0, inf] (d_obs >= 1)", 1),
        ("not eventually (d_obs < 1)", 1),
        ("always (d_obs >= 1) and always (row >= 0)", 2),
        ("not (eventually (d_obs < 1) or eventually (row < 0))", 2),
    ],
)
def test_conditions_that_must_always_hold_are_found(formula, count):
    bundle = compiled(f"hard a: {formula}")
    assert len(step_conditions(bundle, bundle.requirements[0])) == count


@pytest.mark.parametrize(
    "formula",
    [
        "always[0, 5] (d_obs >= 1)",
        "always (once[0, 2] (d_obs >= 1))",
        "always (delta(row) < 1)",
        "eventually (d_goal < 1)",
        "(d_obs >= 1) until (d_goal < 1)",
        "always (d_obs >= 1) or always (row >= 0)",
    ],
)
def test_what_is_no_condition_of_every_sample_is_told_apart(formula):
    bundle = compiled(f"hard a: {formula}")
    assert step_conditions(bundle, bundle.requirements[0]) is None


def test_only_what_can_be_lost_on_the_way_is_remembered():
    text = """hard a: always (d_obs >= 1)
hard b: eventually (d_goal < 1) and (eventually in_a or eventually (in_b and eventually in_a))
hard c: eventually[0, 9] (d_goal < 1)
hard d: d_goal > 2 and eventually in_a
soft e: always (once in_a)"""
    split = split_hard(compiled(text))
    assert len(split.plain) == 1
    assert [requirement.name for requirement in split.remembering] == ["c", "d"]


def test_without_memory_the_states_are_those_of_the_environment():
    found = product_of("always (d_obs >= 1)")
    assert (found.places, found.settled, found.clock) == ((), (), ())
    assert found.transitions == WORLD.transitions
    assert [s for s, bad in enumerate(found.violating) if bad] == [2]
    assert found.robustness[:3] == ((1,), (0,), (-1,))


REMEMBERING = [
    "always (prev (once[0, 1] in_a) implies not in_b)", "always (once[1, 3] in_a implies not in_b)",
    "not in_b until in_a", "always[0, 4] (d_obs >= 1)", "always (abs(delta(row)) < 1 or in_a)",
    "always (now >= 4 or row < 2)", "always (in_a implies eventually[0, 4] in_b)", "always (rate(col) >= 0)",
    "always (historically[0, 3] (row < 2) or in_b)", "always (in_b implies (not in_b since in_a))",
    "d_goal > 2 and always (now < 2 implies row < 1)", "always (prev (delta(row) > 0) implies col > 0)",
    "always (d_obs >= 1) and not in_b until[1, 6] in_a", "always (now * d_obs <= 12)",
]  # fmt: skip


@pytest.mark.parametrize("formula", REMEMBERING)
def test_a_walk_violates_exactly_when_the_evaluator_is_sure_of_it(formula):
    """On random walks: settled where the requirement holds if the walk ends, violating only where it is lost."""
    bundle = compiled(f"hard h: {formula}")
    found = product_of(formula)
    draw = random.Random(formula)
    names = ("d_obs", "d_goal", "row", "col", "in_a", "in_b")
    for _ in range(30):
        state, path = found.start, [WORLD.start]
        while True:
            columns = WORLD.signals(names, path)
            holds = bundle.evaluate({name: columns[name] for name in names})["h"].verdict.value == "satisfied"
            assert found.places[state] == path[-1]
            assert found.settled[state] == holds
            if found.violating[state]:
                assert not holds
                assert set(found.transitions[state]) == {state}
                break
            if len(path) == 12:
                break
            action = draw.randrange(4)
            state = found.transitions[state][action]
            path.append(WORLD.transitions[path[-1]][action])


def test_a_clock_runs_as_far_as_it_matters():
    found = product_of("always (d_obs >= 1)", earliest=3)
    assert max(found.clock) == 3
    assert found.clock[found.start] == 0
    assert found.clock[found.transitions[found.start][1]] == 1


def test_what_no_run_outlasts_is_not_counted():
    for formula in ("always (in_a implies eventually[0, 100000] in_b)", "always (once[0, 100000] in_a or not in_b)"):
        assert product_of(formula).n_states < 40
    assert product_of("always[0, 1000000] (d_obs >= 1)").n_states == 12
    assert product_of("always[0, 40] (d_obs >= 1)").n_states > 300


def test_terminal_states_lead_nowhere():
    lake = make_environment("FrozenLake-v1", {"is_slippery": False}, ("SFF", "FHF", "FFG"))
    text = "signal d_obs\nsignal row\nhard h: always (prev (row > 0) implies row > 0)"
    found = make_product(api.compile(text), lake, lake.transitions, longest=50)
    ends = [s for s, place in enumerate(found.places) if place in lake.terminal]
    assert ends and all(set(found.transitions[s]) == {s} for s in ends)


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("always (once (eventually[0, 2] in_a))", "past operator"),
        ("always (delta(delta(row)) < 1)", "delta or rate of delta"),
        ("always (delta(row) < now)", "both delta or rate and now"),
        ("(eventually (in_a since in_b)) until (eventually once in_b)", "grows with every sample"),
    ],
)
def test_what_has_no_bound_is_refused_with_the_reason(formula, reason):
    with pytest.raises(UsageError) as caught:
        product_of(formula)
    (found,) = caught.value.diagnostics
    assert found.code == "D868"
    assert "'h'" in found.message and reason in found.message


def test_too_many_states_are_refused_with_the_number(monkeypatch):
    monkeypatch.setattr(product, "MOST_STATES", 200)
    with pytest.raises(UsageError) as caught:
        product_of("always (once[0, 1000] in_a implies not in_b)", longest=5000)
    (found,) = caught.value.diagnostics
    assert found.code == "D878"
    assert "12 states" in found.message and "200" in found.message
