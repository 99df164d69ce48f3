"""Formulas are written as the user would write them, and read back as the same formula."""

import random

import pytest

import stlspec
from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import Builder
from stlspec.compiler.notation import formula_texts
from stlspec.compiler.printing import LONGEST

STEP = TimeBase("step", "step", 1)
SIGNALS = "signal x\nsignal y\nsignal p: bool\nsignal q: bool\n"


def text_of(bundle: stlspec.Bundle, requirement: int = 0) -> str:
    root = bundle.requirements[requirement].root
    return formula_texts(bundle.nodes, root, bundle.time, bundle.names)[root]


@pytest.mark.parametrize(
    "text",
    [
        "always (x >= 1)",
        "eventually[0, 5] p",
        "always[2, inf] not p",
        "always (p implies (eventually[0, 3] (y < 1)))",
        "p iff q",
        "p implies x > 1",
        "p and x > 1 and not q",
        "(p or q) and x < 2",
        "p until[1, 4] q",
        "(x > 1) until q",
        "p unless[0, 4] q",
        "p unless q",
        "p release[1, 2] q",
        "(not p) since q",
        "historically once[1, 2] p",
        "next p",
        "wnext (x > 1)",
        "wprev p",
        "prev prev p",
        "true",
        "abs(x - y) <= 2 * x + 1",
    ],
)
def test_what_the_user_wrote_is_what_is_shown(text: str) -> None:
    shown = text_of(stlspec.compile(f"{SIGNALS}hard h: {text}\n"))
    assert shown == text.replace("(not p)", "not p")


def test_a_let_inside_a_formula_stands_under_its_name() -> None:
    bundle = stlspec.compile(f"{SIGNALS}let near = x < 1\nhard h: always (near or p)\n")
    texts = formula_texts(bundle.nodes, bundle.requirements[0].root, bundle.time, bundle.names)
    assert texts[bundle.requirements[0].root] == "always (near or p)"
    assert texts[bundle.names["near"]] == "x < 1"


def test_bounds_carry_the_unit_of_the_spec() -> None:
    bundle = stlspec.compile(f"time 125 ms\n{SIGNALS}hard h: always[0, 0.5 s] eventually[250 ms, inf] p\n")
    assert text_of(bundle) == "always[0, 500 ms] eventually[250 ms, inf] p"


def random_text(rng: random.Random, depth: int) -> str:
    """A formula of the language, fully parenthesised."""
    if depth == 0:
        return rng.choice(["p", "q", "(x > 1)", "(y <= x + 2)", "(0 <= x < 3)"])
    word = rng.choice("always eventually[1,3] not historically once[0,2] next prev wnext wprev".split())
    infix = rng.choice("and or implies iff xor until[0,2] since release[1,4] unless[0,3]".split())
    if rng.random() < 0.5:
        return f"({word} {random_text(rng, depth - 1)})"
    return f"({random_text(rng, depth - 1)} {infix} {random_text(rng, depth - 1)})"


@pytest.mark.parametrize("seed", range(60))
def test_a_text_reads_back_as_the_same_formula(seed: int) -> None:
    rng = random.Random(seed)
    bundle = stlspec.compile(f"{SIGNALS}hard h: {random_text(rng, rng.randint(0, 3))}\n")
    shown = text_of(bundle)
    if "…" not in shown:
        again = stlspec.compile(f"{SIGNALS}hard h: {shown}\n")
        assert again.nodes == bundle.nodes


def test_a_shared_formula_is_cut_before_its_text_explodes() -> None:
    builder = Builder()
    node = builder.add("bool", value="p")
    for _ in range(200):
        node = builder.add("and", [node, node])
    text = formula_texts(builder.nodes, node, STEP)[node]
    assert len(text) == LONGEST
    assert text.endswith("…")
