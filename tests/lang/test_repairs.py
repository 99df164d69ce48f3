"""A fix has been tried: made as it stands, it clears the statement; where nothing helps, none is offered."""

import random

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText
from tests.lang.slips import fault


def only(text):
    (problem,) = parse(SourceText.of("s", text)).diagnostics
    return problem


@pytest.mark.parametrize(
    ("broken", "fixed"),
    [
        ("hard a: always[0, 5 (x > 1)", "hard a: always[0, 5] (x > 1)"),
        ("hard a: always[0, 5 -x < 1", "hard a: always[0, 5] -x < 1"),
        ("hard a: F[0, 1] p and (G[1 s, 7 (x > 2))", "hard a: F[0, 1] p and (G[1 s, 7] (x > 2))"),
        ("hard a: F[0, 1] p or (q since[0, 7 close)", "hard a: F[0, 1] p or (q since[0, 7] close)"),
        ("hard a: always (abs(x > 1)", "hard a: always (abs(x) > 1)"),
        ("hard a: ((x > 1 or p", "hard a: ((x > 1 or p))"),
        ("hard a: (p and q]", "hard a: (p and q)"),
        ("hard a: p and q)", "hard a: p and q"),
        ("hard a: p and  # c", "hard a: p  # c"),
        ("hard a: p and not always[0, 5]", "hard a: p"),
        ("hard a: (p and) or q", "hard a: (p) or q"),
        ("hard a: p and and q", "hard a: p and q"),
        ("hard a: always[0 5] p", "hard a: always[0, 5] p"),
        ("hard a: always(0, 5] p", "hard a: always[0, 5] p"),
        ('signal x "distance', 'signal x "distance"'),
        ("time 100", "time 100 s"),
        ("param T =", "param T"),
        ("hard a always (x > 1)", "hard a: always (x > 1)"),
        ('hard a "A" = always (x > 1)', 'hard a "A" : always (x > 1)'),
        ("soft a depends b: x > 1", "soft a depends on b: x > 1"),
        ("soft a depends on b c: x > 1", "soft a depends on b, c: x > 1"),
        ("signal x [0, 5]", "signal x in [0, 5]"),
        ("signal x bool", "signal x: bool"),
        ("let p x > 1", "let p = x > 1"),
        ("param T 8 s", "param T = 8 s"),
        ("expect a holds on {x = [1]}", "expect a holds on {x : [1]}"),
        ("expect a holds on {x: [1]} margin 2", "expect a holds on {x: [1]} margin >= 2"),
        ("hard a: (p and\n  ) or q", "hard a: (p\n  ) or q"),
    ],
)
def test_the_fix_clears_the_statement(broken, fixed):
    problem = only(broken)
    assert problem.fixes[0].applied(broken) == fixed
    assert parse(SourceText.of("s", fixed)).diagnostics == ()


@pytest.mark.parametrize(
    ("broken", "offset", "way"),
    [
        ("soft a depends on\n  always (x > 1)", 17, "write a name after `on`"),
        ("soft a\n  always (x > 1)", 6, "write `:` after `a`"),
        ("hard a: x >\n  and y < 1", 11, "write a number or a signal after `>`"),
        ("hard a: always[0,\n  ] p", 17, "write a number or a signal after `,`"),
    ],
)
def test_a_line_that_ends_too_early_is_blamed_not_the_next(broken, offset, way):
    problem = only(broken)
    assert (problem.span.start, problem.help) == (offset, way)


@pytest.mark.parametrize("broken", ["hard a: not", "hard a: x >", "hard a:", "hard a: always[0, -x < 1"])
def test_no_fix_is_offered_where_none_is_known(broken):
    assert only(broken).fixes == ()


def test_slips_of_the_hand_are_cleared_by_their_help():
    rng = random.Random(11)
    assert [found for _ in range(400) if (found := fault(rng))] == []


def test_many_broken_statements_cost_no_more_than_their_descriptions():
    text = "hard a: (x > 1\n" * 300
    problems = parse(SourceText.of("s", text)).diagnostics
    assert len(problems) == 300
    assert problems[0].fixes
    assert not problems[-1].fixes
