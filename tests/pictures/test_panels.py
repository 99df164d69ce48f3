"""Panels: one chart for each signal and requirement, which says in words what it shows."""

from xml.etree import ElementTree

import numpy as np

import stlspec
from stlspec.demos import make_demonstration
from stlspec.pictures.contents import Picture, picture_of
from stlspec.pictures.panels import panels
from stlspec.semantics.explain import explain

SPEC = """time s
signal x unit "m"
signal door: bool
hard near: always (x <= 2)
soft closed: always not door
"""


def test_each_panel_is_described_in_words() -> None:
    bundle = stlspec.compile(SPEC)
    demo = make_demonstration("d", {"x": [1, 3, 2], "door": [False] * 3}, time=[0, 1, 3])
    (score,) = stlspec.score(bundle, [demo]).demonstrations
    picture = picture_of(bundle, score, {n: explain(bundle, n, s.result) for n, s in score.requirements.items()})
    roots = [ElementTree.fromstring(svg) for svg in panels(picture)]
    assert [r.find("title").text for r in roots] == [
        "x [m]",
        "door",
        "near (hard): violated, robustness -1",
        "closed (soft): satisfied, robustness ∞",
    ]
    assert roots[0].find("desc").text == "from 1 to 3; near violated from 0.5 to 2; near decided at 1 by 3"
    assert "3 s" in [e.text for e in roots[0].iter("text")]


def test_a_picture_without_samples_has_no_panels() -> None:
    assert panels(Picture("t", "", None, np.zeros(0), "step", (), ())) == []
