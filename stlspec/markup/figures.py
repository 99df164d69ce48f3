"""What all figures share: the frame of an SVG, its style, and the form it has in a notebook.

In: drawn parts. Out: an SVG element that a screen reader announces by title and description. Colours are
variables of one style sheet with a light and a dark set, so that a figure follows its page. Ids are numbered from
the content, so that the same figure is the same text.
"""

from functools import lru_cache
from hashlib import blake2b
from importlib.resources import files

from stlspec.markup.elements import Markup, element, join, text, trusted


@lru_cache(maxsize=1)
def style() -> Markup:
    """Return the style sheet of all figures and tables. Not in the paper: looks."""
    return trusted(files("stlspec.markup").joinpath("figures.css").read_text(encoding="utf-8"))


def figure(width: float, height: float, title: str, description: str, *parts: object) -> Markup:
    """Frame drawn parts as an SVG that says what it shows.

    Not in the paper: packaging.

    Args:    width, height: in pixels at full size. title: read out as its name. description: what can be seen.
    Returns: an SVG element for an HTML page that holds `style()`; see `standalone`.
    """
    drawn = join(parts)
    key = blake2b(f"{title}\0{description}\0{drawn}".encode(errors="replace"), digest_size=6).hexdigest()
    return element(
        "svg",
        element("title", title, id=f"t{key}"),
        element("desc", description, id=f"d{key}") if description else None,
        drawn,
        class_="stl-fig",
        role="img",
        viewBox=f"0 0 {width:g} {height:g}",
        width=width,
        height=height,
        aria_labelledby=f"t{key}" + (f" d{key}" if description else ""),
    )


def standalone(svg: Markup) -> str:
    """Return a figure that brings its style along: for a file, or the `_repr_svg_` of a notebook."""
    head = '<svg xmlns="http://www.w3.org/2000/svg"' + svg.removeprefix("<svg").partition(">")[0] + ">"
    return head + element("style", style()) + svg.partition(">")[2]


def notebook(*parts: Markup) -> str:
    """Return markup that brings the style along: for the `_repr_html_` of a notebook."""
    return str(element("div", element("style", style()), *parts))


def label(x: float, y: float, content: object, class_: str | None = None, anchor: str | None = None) -> Markup:
    """Write a line of text into a figure."""
    return element("text", text(content), x=f"{x:.1f}", y=f"{y:.1f}", class_=class_, text_anchor=anchor)
