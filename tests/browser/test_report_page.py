"""The report in a real browser: no errors, no requests, both colour schemes, keyboard only."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import stlspec
from stlspec.demos import make_demonstration
from stlspec.pages.score_page import score_page
from tests.browser.conftest import CONTRAST

pytestmark = pytest.mark.browser
SPECS = Path(__file__).parents[2] / "specs"
HOSTILE = '</script><img src="http://evil.example/x" onerror="document.title=1"><script>document.title="owned"</script>'


def written(folder: Path, bundle: Any, demos: Any) -> str:
    file = folder / "report.html"
    file.write_text(score_page(bundle, stlspec.score(bundle, demos), demos), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def lake(tmp_path: Path) -> str:
    bundle = stlspec.compile(SPECS / "frozenlake_8x8.stl")
    return written(tmp_path, bundle, stlspec.load_demonstrations([SPECS / "demos" / "frozenlake_8x8.jsonl"]))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_readable_in_both_colour_schemes(lake: str, scheme: str, visit: Callable[..., Any]) -> None:
    page = visit(lake, scheme)
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, paper.strip("rgb()").split(","))) > 600) == (scheme == "light")
    assert page.evaluate(CONTRAST) == []
    assert page.locator("main, header, footer, nav").count() == 4
    for figure in page.locator("svg[role=img]").all():
        assert page.evaluate("e => e.getAttribute('aria-labelledby').split(' ').every(i => document.getElementById(i))",
                             figure.element_handle())  # fmt: skip


def test_a_row_leads_to_what_explains_it_by_keyboard(lake: str, visit: Callable[..., Any]) -> None:
    page = visit(lake)
    page.get_by_role("button", name="Unfold all").press("Enter")
    if page.locator("details[open]").count():
        page.get_by_role("button", name="Fold all").press("Enter")
    assert page.locator("details[open]").count() == 0
    page.get_by_role("link", name="into a hole").press("Enter")
    page.wait_for_function("() => document.querySelector('details[open]')")
    assert page.locator("details[open]").count() == 1
    assert page.evaluate("document.activeElement.innerText").startswith("into a hole")
    assert page.get_by_text("d_obs = 0, needs >= 1, at sample 5").is_visible()


def test_it_needs_no_script_to_be_read(lake: str, browser: Any) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(lake)
    assert page.locator("details summary").first.is_visible()
    assert not page.locator("#all").is_visible()
    context.close()


def test_it_fits_a_narrow_window(lake: str, visit: Callable[..., Any]) -> None:
    page = visit(lake, width=360)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_a_thousand_hostile_demonstrations_open_fast_and_run_nothing(tmp_path: Path, visit: Callable[..., Any]) -> None:
    bundle = stlspec.compile('spec s "</title><script>document.title=2</script>"\nsignal x\nhard h: always (x > 0)\n')
    demos = [make_demonstration(f"{HOSTILE} {k}", {"x": [k % 3, 1 + k]}) for k in range(1000)]
    page = visit(written(tmp_path, bundle, demos))
    assert page.title() == "</title><script>document.title=2</script> · stlspec"
    assert page.locator("img").count() == 0
    took = page.evaluate("performance.getEntriesByType('navigation')[0].domComplete")
    assert took < 5000
    page.get_by_label("Show only rows with").fill('"owned"</script> 77')
    assert page.locator("#ranking tbody tr:visible").count() == 11, "77, and 770 to 779"
