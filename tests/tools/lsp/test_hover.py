"""What is under the pointer is explained, with what is known of it."""

import pytest

from stlspec.tools.lsp.hover import hover
from stlspec.tools.lsp.workspace import Workspace

TEXT = """time 100 ms
signal d_obs unit "m" in [0, 50] from "obs[0]" "Distance to the *nearest* obstacle"
signal on: bool
param T = 2 s "How long"
param U_max
let near = d_obs < 1 m
let slow(v) = rate(v) < 0.001 m/ms   # stlspec: ignore L609
let half = d_obs / 2
hard avoid "Never touch": # why
    always (d_obs >= 1 m)
soft reach depends on avoid scale 2:
    G[0, T] (eventually[0, 5 s] near -> on and slow(d_obs) and half < 3 m and now < U_max)
"""
SIGNS = str.maketrans({"\\": ""})


def shown(mark, text=TEXT, within=0):
    space = Workspace()
    space.open("untitled:1", 1, text)
    found = hover(space.reviewed("untitled:1"), text.index(mark) + within)
    return found and found.markdown.translate(SIGNS)


@pytest.mark.parametrize(
    ("mark", "parts"),
    [
        (
            "d_obs >= 1",
            [
                'signal d_obs unit "m" in [0, 50] from "obs[0]"\n',
                "*nearest*",
                "in `m`",
                "[0, 50]",
                "Read from `obs[0]`",
            ],
        ),
        ("on and", ["signal on: bool", "True or false"]),
        ("T] (even", ["param T = 2 s", "How long", "Value: 2 s"]),
        ("U_max)", ["Without a value", "-p U_max=VALUE"]),
        ("near ->", ["let near = d_obs < 1 m", "A formula.", "Horizon: 0,"]),
        ("slow(d", ["let slow(v) = rate(v) < 0.001 m/ms\n", "template"]),
        ("half <", ["A number in `m`."]),
        ("avoid scale", ["Never touch", "hard avoid: always (d_obs >= 1 m)", "Weight 2 → 0.731", "to the end"]),
        ("reach", ["soft reach depends on avoid", "Weight 1 → 0.269", "Horizon: 7000 ms"]),
        ("v) < 0", ["An argument"]),
        ("G[0, T]", ["always[a, b] p", "every sample", "from 0 to 2000 ms"]),
        ("eventually", ["eventually[a, b] p", "some sample", "from 0 to 5000 ms"]),
        ("->", ["p implies q"]),
        (">= 1 m", ["f >= g"]),
        ("rate", ["rate(x)", "per unit of time"]),
        ("now", ["since the first sample"]),
        ("scale", ["scale NUMBER"]),
        ("depends", ["depends on A, B"]),
        ("from", ["another column"]),
        ("bool", ["is a formula by itself"]),
        ("hard", ["must hold"]),
        ("time", ["How time is measured"]),
        ("L609", ["L609", "equality"]),
    ],
)
def test_hover_says_what_is_known(mark, parts):
    text = shown(mark)
    assert text is not None
    assert [part for part in parts if part not in text] == []


@pytest.mark.parametrize("mark", ["nearest", "# why", "why", "2 s", "5 s"])
def test_nothing_is_said_of_texts_comments_and_numbers(mark):
    assert shown(mark) is None


def test_the_doc_is_shown_as_it_is_written():
    space = Workspace()
    space.open("untitled:1", 1, 'signal x "<img src=a> *b* `c`"\n')
    text = hover(space.reviewed("untitled:1"), 7).markdown
    assert "\\<img src=a\\> \\*b\\* \\`c\\`" in text


def test_in_a_broken_statement_words_are_explained_and_in_a_good_one_all_the_rest():
    text = TEXT.replace("soft reach", "soft reach reach")
    assert "every sample" in shown("always", text)
    assert "once the spec has no errors" in shown("avoid", text)
    assert "another column" in shown("from", text)
    assert "some sample" in shown("eventually", text)


def test_a_text_that_is_refused_has_nothing_to_say():
    assert shown("signal", "signal x\0") is None
