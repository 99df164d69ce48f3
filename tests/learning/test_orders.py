"""Goals, and the orders that the spec leaves."""

from itertools import permutations

import pytest

from stlspec import api
from stlspec.errors import UsageError
from stlspec.learning.goals import find_agenda
from stlspec.learning.orders import check_orders, count_orders, make_visits, next_goals, together

NAMES = "abcdefgh"
HEAD = "".join(f"signal x{n}\nlet {n} = x{n} < 1\n" for n in NAMES)


def visits_of(text, shared=()):
    """Return the goals where each of a to h holds in one state of its own; pairs in `shared` share one."""
    bundle = api.compile(HEAD + text)
    agenda = find_agenda(bundle)
    used = {c for w in agenda.wishes for c in w.conditions}
    used |= {c for g in agenda.guards for c in (*g.keep, *g.until)}
    holds = {}
    for condition in used:
        name = next(n for n, node in bundle.names.items() if node == condition.node)
        home = dict(shared).get(name, name)
        holds[condition] = [(n == home) != condition.negated for n in NAMES]
    return make_visits(bundle, agenda, holds)


def pairs(visits):
    return {visits[b].name + v.name for v in visits for b in v.before}


@pytest.mark.parametrize(
    ("text", "names", "before"),
    [
        ("soft s: eventually a and eventually b", "ab", set()),
        ("soft s: eventually (a and eventually (b and eventually c))", "abc", {"ab", "ac", "bc"}),
        ("soft s: eventually a and eventually b and (not b until a)", "ab", {"ab"}),
        ("soft s: eventually b and (not b unless a)\nsoft t: eventually a", "ba", {"ab"}),
        ("hard s: not b until a\nsoft t: eventually b", "ab", {"ab"}),
        ("soft s: eventually a\nsoft t depends on s: eventually b", "ab", {"ab"}),
        ("soft s: eventually a\nsoft t depends on s: eventually a and eventually[0, 9] b", "ab", {"ab"}),
        ("soft s: eventually a and eventually b\nsoft t depends on s: eventually[0, 9] b", "ab", set()),
        ("soft s: eventually a\nsoft m depends on s: always a\nsoft t depends on m: eventually b", "ab", {"ab"}),
        ("hard s: always (a implies eventually b)\nsoft t depends on s: eventually c", "bc", set()),
        ("soft s: (not b until a) and (not a until b)", "ab", {"ab"}),
        ("soft s: eventually (a and eventually b)\nsoft t: not a until b", "ab", {"ab"}),
        ("soft s: eventually (a and eventually (b and eventually a))", "aba", {"ab", "aa", "ba"}),
        ("soft s: eventually (a and eventually a)", "a", set()),
    ],
)
def test_what_comes_before_what(text, names, before):
    visits = visits_of(text)
    assert "".join(visit.name for visit in visits) == names
    assert pairs(visits) == before


def test_goals_that_the_same_states_fulfil_are_one():
    assert [v.name for v in visits_of("soft s: eventually a and eventually b", shared=[("b", "a")])] == ["a"]


def test_a_goal_that_no_state_fulfils_is_left_out_unless_it_is_the_only_one():
    assert [v.name for v in visits_of("soft s: eventually a and eventually b", shared=[("b", "none")])] == ["a"]
    assert [v.name for v in visits_of("soft s: eventually b", shared=[("b", "none")])] == ["b"]


@pytest.mark.parametrize(
    "text",
    [
        "soft s: eventually a and eventually b and eventually c and eventually d",
        "soft s: eventually (a and eventually b) and eventually (c and eventually d)",
        "soft s: eventually (a and eventually b) and eventually (a and eventually c) and eventually d",
        "soft s: eventually (a and eventually (b and eventually (c and eventually d)))",
    ],
)
def test_orders_are_counted_and_grown_as_permutations_that_respect_the_rules(text):
    visits = visits_of(text)
    rules = pairs(visits)
    allowed = [
        order
        for order in permutations(range(len(visits)))
        if all(order.index(i) < order.index(j) for j, v in enumerate(visits) for i in v.before)
    ]
    grown = [()]
    for _ in visits:
        grown = [(*done, goal) for done in grown for goal in next_goals(visits, done)]
    assert sorted(grown) == sorted(allowed), rules
    assert count_orders(visits) == len(allowed)


def test_six_goals_in_any_order_are_taken_and_seven_refused_with_the_number():
    check_orders(visits_of("soft s: " + " and ".join(f"eventually {n}" for n in "abcdef")))
    with pytest.raises(UsageError) as caught:
        check_orders(visits_of("soft s: " + " and ".join(f"eventually {n}" for n in "abcdefg")))
    (found,) = caught.value.diagnostics
    assert found.code == "D867"
    assert "5,040" in found.message and "720" in found.message


def test_eight_goals_are_taken_where_few_orders_are_left():
    chain = "eventually (" + " and eventually (".join(NAMES) + ")" * 8
    check_orders(visits_of(f"soft s: {chain}"))


def test_so_many_goals_that_orders_are_not_counted_are_refused_at_once():
    visits = visits_of("soft s: eventually a") * 40
    with pytest.raises(UsageError) as caught:
        check_orders(visits)
    assert "over 720" in caught.value.diagnostics[0].message


def test_conditions_hold_together_where_each_does():
    assert together({"x": [True, True, False], "y": [True, False, True]}, ("x", "y")) == (True, False, False)
