"""The report holds every part, in bounded size, and nothing a user named runs in it."""

import time
from html.parser import HTMLParser
from pathlib import Path

import pytest

import stlspec
from stlspec.demos import make_demonstration
from stlspec.pages.score_page import ends_of, score_page

SPECS = Path(__file__).parents[2] / "specs"
HOSTILE = '"><script>alert(1)</script><img src=x onerror=alert(2)>'


class Elements(HTMLParser):
    """Collects the elements of a page and checks that they are closed."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict]] = []
        self.open: list[str] = []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.seen.append((tag, dict(attrs)))
        if tag not in ("meta", "br", "input"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def count(self, tag: str) -> int:
        return sum(name == tag for name, _ in self.seen)


def page_of(spec: str, demos: str, **params) -> str:
    bundle = stlspec.compile(SPECS / f"{spec}.stl", params=params)
    loaded = stlspec.load_demonstrations([SPECS / "demos" / demos])
    return score_page(bundle, stlspec.score(bundle, loaded), loaded)


@pytest.mark.parametrize(
    ("spec", "demos", "params"),
    [
        ("frozenlake_8x8", "frozenlake_8x8.jsonl", {}),
        ("grid_single_goal", "grid_5x5.jsonl", {"T_goal": 8}),
        ("example_1", "example_1.json", {}),
        ("example_2", "example_2.csv", {}),
        ("mountain_car", "mountain_car.jsonl", {}),
    ],
)
def test_every_part_is_there_under_a_heading_and_ids_are_unique(spec: str, demos: str, params: dict) -> None:
    page = page_of(spec, demos, **params)
    found = Elements(page)
    ids = [attrs["id"] for _, attrs in found.seen if "id" in attrs and attrs["id"] != "stl-hatching"]
    for key in ("contents", "requirements", "ranking", "reward", "why", "d0"):
        assert ids.count(key) == 1
    for _, attrs in found.seen:
        if attrs.get("href", "").startswith("#"):
            assert attrs["href"][1:] in ids
        assert not [name for name in attrs if name.startswith("on") or name in ("src", "style")]
    assert (found.count("main"), found.count("h1"), found.count("script")) == (1, 1, 1)
    assert page == page_of(spec, demos, **params)


def test_nothing_that_a_user_named_becomes_markup() -> None:
    quiet = stlspec.compile('spec s "<b>t</b>"\nsignal x "<i>"\nhard h "<script>x</script>": always (x > 0)\n')
    demos = [make_demonstration(HOSTILE, {"x": [1, -1]}), make_demonstration("</details></main>", {"x": [1, 1]})]
    found = Elements(score_page(quiet, stlspec.score(quiet, demos), demos))
    assert (found.count("script"), found.count("img"), found.count("i"), found.count("b")) == (1, 0, 0, 0)


def test_a_thousand_demonstrations_stay_small_and_say_what_is_left_out() -> None:
    bundle = stlspec.compile("signal x\nhard h: always (x > 0)\nsoft s depends on h: eventually (x > 3)\n")
    demos = [make_demonstration(f"demo {k}", {"x": [1 + k % 7, (k % 3) - 1 + k / 1000]}) for k in range(1000)]
    ranking = stlspec.score(bundle, demos)
    start = time.process_time()
    page = score_page(bundle, ranking, demos)
    assert time.process_time() - start < 10
    assert len(page) < 2_000_000
    found = Elements(page)
    assert found.count("details") == 100
    assert "900 demonstrations between them are left out" in page
    order = ranking.best_first()
    for k in (order[0], order[-1]):
        assert f'href="#d{k}"' in page


def test_a_long_trace_with_many_requirements_is_bounded() -> None:
    lines = [f"hard r{k}: always (x > {k})\n" for k in range(30)]
    bundle = stlspec.compile("signal x\n" + "".join(lines))
    demos = [make_demonstration("long", {"x": [k % 40 for k in range(50_000)]})]
    assert len(score_page(bundle, stlspec.score(bundle, demos), demos)) < 600_000


def test_at_a_sample_and_without_demonstrations_there_is_still_a_page() -> None:
    bundle = stlspec.compile("signal x\nhard h: always (x > 0)\n")
    demos = [make_demonstration("a", {"x": [1, 2]})]
    assert "values at sample 1" in score_page(bundle, stlspec.score(bundle, demos, at=1), demos)
    assert "0 demonstrations against 1 requirement" in score_page(bundle, stlspec.score(bundle, []), [])


def test_an_open_verdict_has_an_enclosure() -> None:
    bundle = stlspec.compile("signal x\nhard h: always[0, 5] (x > 0)\n")
    demos = [make_demonstration("a", {"x": [1, 2]})]
    page = score_page(bundle, stlspec.score(bundle, demos, end="interval"), demos)
    assert "[-∞, 1]" in page
    assert "undecided" in page


def test_the_ends_of_a_list() -> None:
    assert ends_of([1, 2, 3, 4, 5], 3) == [1, 2, 5]
    assert ends_of([1, 2], 5) == [1, 2]
