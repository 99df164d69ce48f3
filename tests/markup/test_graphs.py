"""The DAG as a picture: every requirement once, prerequisites left of dependants, no edge said twice."""

from xml.etree import ElementTree

import stlspec
from stlspec.markup.graphs import MOST_NODES, dag_svg

SPEC = """signal x
hard a: always (x > 0)
soft b depends on a: eventually (x > 1)
soft c depends on a, b: eventually (x > 2)
hard alone: eventually (x > 3)
"""


def drawn(spec: str) -> ElementTree.Element:
    return ElementTree.fromstring(dag_svg(stlspec.compile(spec)))


def nodes(root: ElementTree.Element) -> dict[str, dict]:
    found = {}
    for group in root.iter("g"):
        box = next((e for e in group if "stl-node" in (e.get("class") or "")), None)
        if box is not None:
            name = next(e.text for e in group if e.get("class") == "stl-name")
            texts = [e.text for e in group if e.tag == "text"]
            found[name] = {
                "x": float(box.get("x")),
                "y": float(box.get("y")),
                "class": box.get("class"),
                "texts": texts,
            }
    return found


def test_requirements_stand_right_of_all_they_depend_on() -> None:
    found = nodes(drawn(SPEC))
    assert found["a"]["x"] == found["alone"]["x"] < found["b"]["x"] < found["c"]["x"]
    assert len({(n["x"], n["y"]) for n in found.values()}) == 4
    assert "stl-hard" in found["a"]["class"]
    assert "stl-hard" not in found["b"]["class"]


def test_weights_are_shown_raw_and_after_softmax() -> None:
    # |Φ| = 4; ancestors: a 0, b 1, c 2, alone 0; softmax of (4, 3, 2, 4) by hand
    shown = {name: n["texts"][1] for name, n in nodes(drawn(SPEC)).items()}
    assert shown == {
        "a": "hard · weight 0.399 (raw 4)",
        "b": "soft · weight 0.147 (raw 3)",
        "c": "soft · weight 0.054 (raw 2)",
        "alone": "hard · weight 0.399 (raw 4)",
    }


def test_an_edge_that_a_longer_path_says_is_left_out() -> None:
    root = drawn(SPEC)
    assert len([e for e in root.iter("path") if e.get("class") == "stl-edge"]) == 2
    assert root.find("desc").text == "b depends on a; c depends on b"


def test_a_graph_that_nobody_could_read_is_not_drawn() -> None:
    lines = "".join(f"hard r{k}: always (x > {k})\n" for k in range(MOST_NODES + 1))
    assert dag_svg(stlspec.compile("signal x\n" + lines)) is None


def test_a_bundle_shows_its_graph_in_a_notebook() -> None:
    assert ElementTree.fromstring(stlspec.compile(SPEC)._repr_svg_()).tag.endswith("svg")
