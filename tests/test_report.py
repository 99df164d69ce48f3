"""Results are readable: nothing is cut off, infinities are signs, the path is on the map."""

import io
from pathlib import Path

import pytest

import stlspec
from stlspec import report
from stlspec.learning.lessons import Source

SPECS = Path(__file__).parents[1] / "specs"


def ranking(spec: str, demos: str) -> stlspec.Ranking:
    bundle = stlspec.compile(SPECS / spec)
    return stlspec.score(bundle, stlspec.load_demonstrations([SPECS / "demos" / demos]))


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0"), (float("inf"), "∞"), (float("-inf"), "-∞"), (1 / 3, "0.3333"), (None, "–")]
)
def test_numbers_are_short(value: float | None, text: str) -> None:
    assert report.shown_number(value) == text


def test_the_ranking_is_best_first_with_reasons() -> None:
    stream = io.StringIO()
    report.print_ranking(ranking("frozenlake_8x8.stl", "frozenlake_8x8.jsonl"), stream)
    lines = stream.getvalue().splitlines()
    order = [next(i for i, line in enumerate(lines) if name in line) for name in ("along the rim", "into a hole")]
    assert order == sorted(order)
    assert "into a hole: avoid fails at sample 5: d_obs = 0, needs >= 1" in lines
    assert not [line for line in lines if "…" in line or "\x1b" in line]


def test_a_vacuous_requirement_is_marked_and_explained(tmp_path: Path) -> None:
    file = tmp_path / "x.csv"
    file.write_text("x\n1\n1\n")
    bundle = stlspec.compile("signal x\nhard late: always[5, 9] (x > 0)\n")
    stream = io.StringIO()
    report.print_ranking(stlspec.score(bundle, stlspec.load_demonstrations([file])), stream)
    assert "✓ ∞ ∅" in stream.getvalue()
    assert "counts 0" in stream.getvalue()


def test_the_source_of_a_reward_is_printed_as_it_is() -> None:
    stream = io.StringIO()
    report.print_source(Source((0, 1), 0.5, (), 1.0, (), False), stream)
    assert stream.getvalue() == "state [0, 1]: reward 0.5\nno demonstration gives it a value\n"


def test_progress_is_silent_where_there_is_no_terminal() -> None:
    stream = io.StringIO()
    with report.progress(stream) as show:
        show(1, 2, 3)
    assert stream.getvalue() == ""
