"""Results are readable: nothing is cut off, infinities are signs, the path is on the map."""

import io
from dataclasses import replace
from pathlib import Path

import pytest

import stlspec
from stlspec import report
from stlspec.learning.lessons import Source
from stlspec.learning.satisfaction import from_runs

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


def test_a_probability_is_never_rounded_to_a_certainty() -> None:
    values = (0.0, 1.0, 0.5, 0.0001, 0.000107, 0.99996, 1e-20)
    shown = ["0", "1", "0.500", "0.0001", "0.0001", "0.99996", "1.0e-20"]
    assert [report.probability_text(value) for value in values] == shown


def test_the_share_of_runs_comes_with_its_interval_and_a_certain_share_with_none() -> None:
    found = from_runs(stlspec.compile("signal x\nhard a: always (x > 0)"), [{"a": True}] * 199 + [{"a": False}])
    assert report.interval_of(found) == "0.995 (95 % interval 0.972 to 0.999, 200 runs)"
    assert report.interval_of(replace(found, value=0.25, method="exact", n=None)) == "0.250"
