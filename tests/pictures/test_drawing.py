"""Pictures are files of the right kind and of sensible size; what cannot be drawn is refused before any work."""

import struct
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stlspec
from stlspec.demos import make_demonstration
from stlspec.pictures import drawing
from stlspec.pictures.contents import Picture, picture_of
from stlspec.pictures.drawing import check_target, draw_picture, picture_bytes, picture_files
from stlspec.semantics.explain import explain

SPEC = """time s
signal x
signal door: bool
hard near: always (abs(x) <= 2)
soft answer: always (x > 1 implies eventually[0, 2 s] door)
soft late: always[100 s, 200 s] door
"""


def pictured(signals: dict, time, name: str = "demo", spec: str = SPEC) -> Picture:
    bundle = stlspec.compile(spec)
    (score,) = stlspec.score(bundle, [make_demonstration(name, signals, time=time)]).demonstrations
    return picture_of(bundle, score, {n: explain(bundle, n, x.result) for n, x in score.requirements.items()})


def size_of(png: bytes) -> tuple[int, int]:
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    return struct.unpack(">II", png[16:24])


def short(name: str = "demo") -> Picture:
    return pictured({"x": [0, 3, np.inf, -1], "door": [0, 0, 1, 0]}, [0, 1, 1.5, 4], name)


def test_a_png_has_room_for_every_panel() -> None:
    pytest.importorskip("matplotlib")
    picture = short()
    width, height = size_of(picture_bytes(picture))
    assert 1000 <= width <= 1400
    assert 600 <= height <= 1200
    less = replace(picture, requirements=picture.requirements[:1])
    assert size_of(picture_bytes(less))[1] < height


def test_long_traces_give_small_files() -> None:
    pytest.importorskip("matplotlib")
    n = 10_000
    rng = np.random.default_rng(0)
    picture = pictured({"x": rng.normal(0, 1, n), "door": rng.random(n) < 0.5}, np.arange(n) / 10)
    assert len(picture_bytes(picture)) < 400_000
    assert len(picture_bytes(picture, "svg")) < 1_500_000


@pytest.mark.parametrize("name", ["$x$ $", "日本語", "a\nb", "{}%s\\frac", "x" * 300])
def test_any_name_can_be_drawn(name: str) -> None:
    pytest.importorskip("matplotlib")
    size_of(picture_bytes(short(name)))


@pytest.mark.parametrize("x", [[1.0], [np.inf], [1e300, -1e300], [-np.inf, np.inf, 0], [1e-300] * 3])
def test_any_values_can_be_drawn(x: list[float]) -> None:
    pytest.importorskip("matplotlib")
    size_of(picture_bytes(pictured({"x": x, "door": [0] * len(x)}, np.arange(len(x)))))


def test_a_spec_without_requirements_gives_an_empty_picture() -> None:
    pytest.importorskip("matplotlib")
    size_of(picture_bytes(Picture("t", "", None, np.zeros(0), "step", (), ())))


def test_an_svg_is_one_and_holds_no_date() -> None:
    pytest.importorskip("matplotlib")
    data = picture_bytes(short(), "svg")
    assert data.startswith(b"<?xml")
    assert b"dc:date" not in data


def test_no_state_of_matplotlib_stays_changed() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    before, loaded = dict(matplotlib.rcParams), "matplotlib.pyplot" in sys.modules
    picture_bytes(short())
    assert dict(matplotlib.rcParams) == before
    assert ("matplotlib.pyplot" in sys.modules) == loaded


def test_a_folder_is_made_and_nothing_but_the_picture_is_left_in_it(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    draw_picture(short(), tmp_path / "a" / "b" / "c.png")
    assert [p.name for p in (tmp_path / "a" / "b").iterdir()] == ["c.png"]


def test_a_folder_that_cannot_be_made_is_a_diagnostic(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    (tmp_path / "file").write_text("")
    with pytest.raises(stlspec.InputError) as caught:
        draw_picture(short(), tmp_path / "file" / "c.png")
    assert caught.value.diagnostics[0].code == "S092"


def test_files_are_named_after_demonstrations_and_never_leave_the_folder(tmp_path: Path) -> None:
    names = ["../../etc/passwd", "along the rim", "", "a/b.csv#3", "é"]
    files = picture_files(tmp_path, names)
    assert [f.parent for f in files] == [tmp_path] * 5
    assert [f.name for f in files] == [
        "1_passwd.png", "2_along_the_rim.png", "3_demonstration.png", "4_b_csv_3.png", "5_demonstration.png"
    ]  # fmt: skip
    assert picture_files(tmp_path / "one.SVG", ["x"]) == [tmp_path / "one.SVG"]


@pytest.mark.parametrize(
    ("out", "n", "what", "way"),
    [
        ("a.png", 2, "`--plot a.png` names one picture, but there are 2 demonstrations", "name a folder"),
        ("a.pdf", 1, "pictures are not written as .pdf", "name a .png or .svg file"),
    ],
)
def test_what_cannot_be_drawn_is_refused(out: str, n: int, what: str, way: str) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(stlspec.UsageError) as caught:
        check_target(Path(out), n)
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.message) == ("D880", what)
    assert way in problem.help


def test_without_matplotlib_one_diagnostic_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "find_spec", lambda name: None)
    with pytest.raises(stlspec.UsageError) as caught:
        check_target(Path("out"), 1)
    (problem,) = caught.value.diagnostics
    assert problem.code == "D880"
    assert "pip install 'stlspec[plot]'" in problem.help
