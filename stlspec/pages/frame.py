"""The frame of a page: head, style, script, and the files that ship with the package.

In: a body. Out: one HTML document that needs nothing else and asks nobody: its policy forbids every request, and
allows the one style and the one script by their hashes, so that markup smuggled into a name could do nothing.
"""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.resources import files

from stlspec.markup.elements import Markup, element, join, trusted
from stlspec.markup.figures import style


@cache
def asset(name: str) -> Markup:
    """Return a style sheet or a script of this package. Not in the paper: packaging."""
    return trusted(files("stlspec.pages").joinpath(name).read_text(encoding="utf-8"))


def document(title: str, body: Markup, css: str, script: str) -> str:
    """Return a self-contained HTML document.

    Not in the paper: packaging.

    Args: title: of the page. body: its contents. css, script: names of assets that this kind of page adds.
    """
    looks, acts = join([style(), asset("page.css"), asset(css)], "\n"), asset(script)
    policy = (
        f"default-src 'none'; style-src {_hash(looks)}; script-src {_hash(acts)}; base-uri 'none'; form-action 'none'"
    )
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=policy),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="color-scheme", content="light dark"),
        element("title", title),
        element("style", looks),
    )
    return "<!doctype html>\n" + element("html", head, element("body", body, element("script", acts)), lang="en") + "\n"


def _hash(content: str) -> str:
    return f"'sha256-{b64encode(sha256(content.encode()).digest()).decode()}'"
