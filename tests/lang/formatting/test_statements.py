"""Every statement in its canonical form."""

import pytest

from stlspec.lang.formatting.layout import WIDTH
from stlspec.lang.formatting.text import format_text

EVERY = """\
spec a "title"
use "common.stl"
time 100 ms
signal x: real unit "m" in [-1, 5] from "obs.x" "doc"
signal y: bool
param T = -5 s "doc"
param open
let f(a, b) = a < b
hard safe "doc" depends on u, v scale 2 bound tanh:
    always (x > 1)
soft good:
    y
expect safe holds on {x: [1, -2, inf], y: [true, false, true]} at -1 margin >= 0.5
expect safe fails on "a.csv" episode 3
expect "a.csv" episode "first" is good
expect "a.csv" outranks "b.csv"
"""


def test_canonical_statements_stay_as_they_are():
    assert format_text(EVERY) == EVERY


@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ('spec  a\n  "t"', 'spec a "t"\n'),
        ("time\n  step", "time step\n"),
        ("time  .5   s", "time .5 s\n"),
        ('signal x "doc" from "c" in[ 0:5 ] unit "m":real', 'signal x: real unit "m" in [0, 5] from "c" "doc"\n'),
        ("param x=-  5.0  ms", "param x = -5.0 ms\n"),
        ("let f ( a,b )=a", "let f(a, b) = a\n"),
        (
            'hard a bound none scale 2. depends on b,c "doc":p',
            'hard a "doc" depends on b, c scale 2. bound none:\n    p\n',
        ),
        ("expect a fails on {x:[- 1]} margin>=2 at 3", "expect a fails on {x: [-1]} at 3 margin >= 2\n"),
    ],
)
def test_clauses_stand_in_one_order(written, canonical):
    assert format_text(written) == canonical
    assert format_text(canonical) == canonical


def test_clauses_among_comments_keep_their_order():
    written = 'hard a scale 2  # why\n        # since\n        depends on b\n        "doc":\n    p\n'
    assert format_text(written) == written.replace("hard a scale", "hard a\n        scale")


def test_many_samples_fill_lines():
    text = format_text(f"expect a holds on {{x: [{', '.join(['12.5'] * 60)}]}}\n")
    assert max(map(len, text.splitlines())) <= 100
    assert len(text.splitlines()) < 10


@pytest.mark.parametrize("length", range(90, 104))
def test_a_body_behind_a_comment_stays_within_the_width(length):
    body = f"{'a' * (length - 14)} > 1 and b > 2"
    for comment in ("", "# c", "\n# c"):
        lines = format_text(f"let p ={comment}\n{body}\n").splitlines()
        assert max(map(len, lines)) <= WIDTH
        assert (f"    {body}" in lines) == (length + 4 <= WIDTH) or f"let p = {body}" in lines
