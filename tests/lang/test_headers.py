"""Headers in another way: one diagnostic, the way to write them here, and where it is sure a fix that clears it."""

import pytest

from stlspec.lang.parse import parse
from stlspec.source import SourceText


def only(text):
    (problem,) = parse(SourceText.of("s", text)).diagnostics
    return problem


def fixed(text):
    return only(text).fixes[0].applied(text)


@pytest.mark.parametrize(
    ("header", "right"),
    [
        ('hard "No overshoot!":', 'hard no_overshoot "No overshoot!":'),
        ('soft "Comfort" bound linear:', 'soft comfort "Comfort" bound linear:'),
        ("hard no overshoot:", "hard no_overshoot:"),
        ('soft keep it low "in short":', 'soft keep_it_low "in short":'),
        ("soft keep low scale 2:", "soft keep_low scale 2:"),
    ],
)
def test_a_header_is_put_right(header, right):
    text = f"signal x\n{header} x > 1\n"
    assert fixed(text) == f"signal x\n{right} x > 1\n"
    assert parse(SourceText.of("s", fixed(text))).diagnostics == ()


@pytest.mark.parametrize(
    ("statement", "place", "way"),
    [
        ("hard G x > 1", "G", "write a name and `:` before `G`, as in `hard goal: G ...`"),
        ("hard G[0, 5] (x > 1)", "G", "write a name and `:` before `G`, as in `hard goal: G ...`"),
        ("soft always (x > 1)", "always", "write a name and `:` before `always`, as in `soft goal: always ...`"),
        ('signal ego speed unit "m"', "ego speed", "a name has no blanks: write `ego_speed`"),
        ('hard "x": x > 1', '"x"', 'write a name before the title, as in `hard goal "x"`'),
        ('hard "!": x > 1', '"!"', 'write a name before the title, as in `hard goal "!"`'),
    ],
)
def test_where_only_the_author_knows_the_name_there_is_no_fix(statement, place, way):
    problem = only(f"signal x\n{statement}\n")
    assert problem.source.slice(problem.span) == place
    assert (problem.help, problem.fixes) == (way, ())


@pytest.mark.parametrize(
    "statement", ["soft a priority 2: x > 1", "soft a: x > 1 weight 2", "soft a weight = 2: x > 1"]
)
def test_ranks_come_from_depends_on(statement):
    problem = only(f"signal x\n{statement}\n")
    assert problem.source.slice(problem.span) in ("priority", "weight")
    assert "`soft b depends on a` puts b behind a" in problem.help


@pytest.mark.parametrize(
    "statement", ["hard a x > 1", "hard a always x > 1", "soft b a: x > 1", "hard b none: x > 1", "hard always: x > 1"]
)
def test_other_mistakes_of_headers_keep_their_message(statement):
    problems = parse(SourceText.of("s", f"signal x\nhard a: x > 1\n{statement}\n")).diagnostics
    assert [p for p in problems if "blanks" in p.help or "a name and" in p.help] == []
    assert len(problems) == 1


def test_a_name_and_its_type_glued_together_come_apart():
    text = "signal alarmbool :\nhard a: alarm\n"
    assert fixed(text) == "signal alarm : bool\nhard a: alarm\n"
    assert only("signal alarmbool :\nhard a: 1 > 0\n").code == "S002"
