"""The part on one demonstration explains every requirement in words."""

import stlspec
from stlspec.demos import make_demonstration
from stlspec.markup.grids import Board
from stlspec.pages.demonstration import MOST_EXPLAINED, demonstration_section

SPEC = "signal x\nlet near = x < 2\nhard keep: always (near implies eventually[0, 1] (x > 5))\n"


def test_what_decides_is_named_from_the_requirement_down() -> None:
    bundle = stlspec.compile(SPEC)
    (score,) = stlspec.score(bundle, [make_demonstration("a <b>", {"x": [3, 1, 4]})]).demonstrations
    board = Board(("S.", ".G"), path=(0, 1, 3))
    section = demonstration_section(bundle, score, 7, board, unfolded=True)
    assert section.startswith('<details id="d7" open>')
    assert "a &lt;b&gt;" in section
    assert '<span class="label bad">bad</span>' in section
    assert "x = 1, needs &gt;= 2, at sample 1" in section
    assert "Its path, 3 states" in section
    assert section.count("<svg") == 3
    assert "open" not in demonstration_section(bundle, score, 7, None, unfolded=False)[:30]


def test_of_many_requirements_those_that_fail_are_explained_first() -> None:
    lines = [f"hard r{k}: always (x < {k})\n" for k in reversed(range(100))]
    bundle = stlspec.compile("signal x\n" + "".join(lines))
    (score,) = stlspec.score(bundle, [make_demonstration("d", {"x": [20, 10]})]).demonstrations
    section = demonstration_section(bundle, score, 0, None, unfolded=True)
    assert section.count('<dl class="why"') == MOST_EXPLAINED
    assert "r20 (hard)" in section
    assert f"{100 - MOST_EXPLAINED} requirements more" in section
