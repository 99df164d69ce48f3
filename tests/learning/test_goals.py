"""What the spec wants visited, and kept up until then."""

import pytest

from stlspec import api
from stlspec.learning.goals import condition_name, find_agenda, momentary

HEAD = "signal d_obs\nsignal d_goal\nsignal row\nlet A = d_goal < 1\nlet B = row < 1\n"


def compiled(text):
    return api.compile(HEAD + text)


def goals(text):
    bundle = compiled(text)
    return [condition_name(bundle, wish.conditions) for wish in find_agenda(bundle).wishes]


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("eventually (d_goal < 1)", ["A"]),
        ("eventually[0, 9] (d_goal < 1)", ["A"]),
        ("eventually (d_goal < 1) and eventually[2, 4] (d_goal < 1)", ["A", "A"]),
        ("not always (d_goal >= 1)", ["not (d_goal >= 1)"]),
        ("not eventually (d_obs < 1)", []),
        ("always (d_obs >= 1)", []),
        ("eventually always (d_goal < 1)", ["A"]),
        ("eventually (delta(row) > 0)", []),
        ("eventually (now > 3)", []),
        ("always eventually (d_goal < 1)", ["A"]),
        ("d_obs > 2 implies eventually (d_goal < 1)", ["A"]),
        ("eventually (row < 1) implies d_obs > 2", []),
    ],
)
def test_goals_are_the_state_predicates_that_are_wanted_eventually(formula, expected):
    assert goals(f"soft a: {formula}") == expected


def test_a_goal_goes_by_the_name_of_its_let():
    assert goals("let home = d_goal < 2\nsoft a: eventually home") == ["home"]
    assert goals("let both = A and B\nsoft a: eventually both and eventually (A and d_obs > 1)") == [
        "both",
        "A and d_obs > 1",
    ]


def test_momentary_formulas_look_at_the_present_only():
    bundle = compiled("soft a: d_obs + 1 > 2 and not (row < delta(row))")
    found = dict(zip((node.op for node in bundle.nodes), momentary(bundle.nodes), strict=True))
    assert found["gt"]
    assert not found["delta"]
    assert not found["lt"]
    assert not found["and"]


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("eventually (A and eventually B)", [("A", ()), ("B", (0,))]),
        ("eventually (A and eventually (B and eventually A))", [("A", ()), ("B", (0,)), ("A", (0, 1))]),
        ("eventually (A and B)", [("A and B", ())]),
        ("eventually (A and d_obs > 2 and next B)", [("A and d_obs > 2", ())]),
        ("eventually (A or eventually B)", [("A", ()), ("B", ())]),
        ("not B until A", [("A", ())]),
        ("not B unless A", []),
        ("A release B", []),
        ("not always (not A or always B)", [("A", ()), ("not B", (0,))]),
    ],
)
def test_nesting_says_what_comes_before(formula, expected):
    bundle = compiled(f"soft a: {formula}")
    found = [(condition_name(bundle, wish.conditions), wish.after) for wish in find_agenda(bundle).wishes]
    assert [(name.replace("d_obs > 2 and A", "A and d_obs > 2"), after) for name, after in found] == expected


@pytest.mark.parametrize(
    ("formula", "certain", "earliest"),
    [
        ("eventually[3, 5] A", True, 3),
        ("eventually[3, 5] A and B", True, 3),
        ("B implies eventually[3, 5] A", False, 0),
        ("always (B implies eventually[3, 5] A)", False, 0),
        ("B until[3, 5] A", True, 3),
    ],
)
def test_what_is_wanted_for_certain_counts_from_the_begin_of_its_window(formula, certain, earliest):
    (wish,) = find_agenda(compiled(f"soft a: {formula}")).wishes
    assert (wish.certain, wish.earliest) == (certain, earliest)


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("not B until A", [("not B", "A")]),
        ("not B unless A", [("not B", "A")]),
        ("always (d_obs >= 1)", [("d_obs >= 1", "")]),
        ("not eventually (d_obs < 1)", [("not (d_obs < 1)", "")]),
        ("always (d_obs >= 1) or eventually A", []),
        ("eventually always B", []),
        ("(eventually B) until A", []),
        ("not (A until B)", []),
    ],
)
def test_what_is_kept_up_is_found_where_it_is_certain(formula, expected):
    bundle = compiled(f"soft a: {formula}")
    guards = find_agenda(bundle).guards
    assert [(condition_name(bundle, g.keep), condition_name(bundle, g.until)) for g in guards] == expected
    assert not any(guard.hard for guard in guards)
