"""A real Chromium, one for all tests of this folder.

Without Chromium or Playwright these tests are skipped, unless STLSPEC_BROWSER is set, as `.ci/run` sets it: then
their absence is a failure.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

BINARY = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Start Chromium."""
    if os.environ.get("STLSPEC_BROWSER"):
        assert BINARY, "no Chromium is installed"
    elif BINARY is None:
        pytest.skip("no Chromium is installed")
    else:
        pytest.importorskip("playwright")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        # The superuser cannot have a sandbox, and the pages are our own.
        words = ["--no-sandbox"] if os.geteuid() == 0 else []
        started = playwright.chromium.launch(executable_path=BINARY, args=words)
        yield started
        started.close()


@pytest.fixture
def visit(browser: Any) -> Iterator[Callable[..., Any]]:
    """Open pages that must neither log an error nor ask another host for anything."""
    pages: list[tuple[Any, list[str], list[str]]] = []

    def begin(url: str, scheme: str = "light", width: int = 1240, *, outlived: bool = False) -> Any:
        """Open a page. outlived: its server ends before it, and may then refuse what the page still asks for."""
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        problems: list[str] = []
        asked: list[str] = []

        def note(message: Any) -> None:
            refused = outlived and "status of 503" in message.text
            if message.type in ("error", "warning") and not refused:
                problems.append(message.text)

        page.on("console", note)
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(url)
        pages.append((page, problems, asked))
        return page

    yield begin
    for page, problems, asked in pages:
        home = page.url.split("#")[0]
        page.close()
        assert problems == []
        if home.startswith("file:"):
            assert [url for url in asked if url.split("#")[0] != home] == []
        else:
            host = "/".join(home.split("/")[:3]) + "/"
            assert [url for url in asked if not url.startswith(host)] == []


CONTRAST = Path(__file__).with_name("contrast.js").read_text(encoding="utf-8")
"""What is read too badly: texts whose contrast with what is behind them is below 4.5."""
