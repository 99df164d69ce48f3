"""A page asks nobody for anything, and allows the one style and the one script that it holds."""

import base64
import hashlib
import re

from stlspec.markup.elements import element
from stlspec.pages.frame import asset, document


def test_the_policy_allows_just_what_is_in_the_page() -> None:
    page = document("a <title>", element("p", "x"), "score.css", "score.js")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page).group(1).replace("&#x27;", "'")
    assert policy.startswith("default-src 'none'; ")
    for tag, rule in (("style", "style-src"), ("script", "script-src")):
        (content,) = re.findall(f"<{tag}>(.*?)</{tag}>", page, re.S)
        digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        assert f"{rule} 'sha256-{digest}'" in policy
    assert "<title>a &lt;title&gt;</title>" in page
    assert page.startswith("<!doctype html>\n<html lang=")


def test_no_asset_ends_its_own_element() -> None:
    for name in ("page.css", "score.css", "score.js"):
        assert "</" not in asset(name)
        assert "http" not in asset(name)
