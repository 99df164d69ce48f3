"""Lowering: derived operators by their definition, units converted, lets shared, meaning kept."""

import random

import pytest

from stlspec import api
from stlspec.compiler.compiling import compile_source
from stlspec.compiler.ir import Node
from stlspec.source import SourceText

DECLARED = "signal x\nsignal y\nsignal b: bool\n"


def values(formula, declared=DECLARED, seed=0, **more):
    """Robustness of a formula at every sample of a random trace."""
    rng = random.Random(seed)
    n = 25
    trace = {name: [rng.choice([-2.0, -1.0, 0.0, 1.0, 3.0]) for _ in range(n)] for name in "xy"}
    trace["b"] = [rng.random() < 0.5 for _ in range(n)]
    return api.compile(f"{declared}hard a: {formula}").evaluate(trace, **more)["a"].signal.tolist()


@pytest.mark.parametrize(
    ("derived", "definition"),
    [
        ("p implies q", "not p or q"),
        ("p implies q implies b", "p implies (q implies b)"),
        ("p iff q", "(p implies q) and (q implies p)"),
        ("p xor q", "not (p iff q)"),
        ("p xor q xor b", "(p xor q) xor b"),
        ("p release[1, 4] q", "not (not p until[1, 4] not q)"),
        ("p release q", "not ((not p) until (not q))"),
        ("p unless[2, 5] q", "(p until[2, 5] q) or always[0, 5] p"),
        ("p unless q", "(p until q) or always p"),
        ("wnext p", "not next not p"),
        ("wprev p", "not prev not p"),
        ("0 <= x <= 2", "0 <= x and x <= 2"),
        ("3 > x >= y > -1", "3 > x and x >= y and y > -1"),
        ("eventually[1, 3] p", "true until[1, 3] p"),
        ("always[1, 3] p", "not eventually[1, 3] not p"),
        ("once[1, 3] p", "true since[1, 3] p"),
        ("historically[1, 3] p", "not once[1, 3] not p"),
        ("not not p", "p"),
        ("x[t] > 1", "x > 1"),
        ("t < 5", "now < 5"),
        ("G p", "always p"),
        ("x - y - 1 > 0", "(x - y) - 1 > 0"),
        ("-x ** 2 < y", "-(x ** 2) < y"),
        ("2 ** 3 ** 0 > x", "2 > x"),
        ("x / 2 * 3 > y", "(x / 2) * 3 > y"),
    ],
)
def test_a_derived_form_has_the_value_of_its_definition_at_every_sample(derived, definition):
    declared = DECLARED + "let p = x > 0\nlet q = y <= x\n"
    for seed in range(5):
        assert values(derived, declared, seed) == values(definition, declared, seed)


@pytest.mark.parametrize("formula", ["always (x > 0 and not b)", "b until[0, 4] x + y > 1", "x > 0 or b"])
def test_naming_a_part_never_changes_a_value(formula):
    whole = values(formula)
    assert values("whole", f"{DECLARED}let whole = {formula}\n") == whole
    assert values("f", f"let f = g\nlet g = {formula}\n{DECLARED}") == whole


def nodes_of(formula, declared=DECLARED):
    return compile_source(SourceText.of("s", f"{declared}hard a: {formula}")).nodes


def test_constants_are_folded_and_shared():
    nodes = nodes_of("x > 1 + 2 * 3 and y > 7")
    assert [n.value for n in nodes if n.op == "const"] == [7.0]


def test_times_are_brought_to_the_unit_of_the_first_side_that_has_one():
    nodes = nodes_of("now < T and T > now", "time 100 ms\nparam T = 2 s\n")
    assert [n.value for n in nodes if n.op == "const"] == [2000.0, 2.0, 1000.0]
    assert [n.op for n in nodes] == ["now", "const", "lt", "const", "const", "div", "gt", "and"]


def test_a_param_is_a_constant_and_a_bool_signal_a_formula():
    assert nodes_of("b and x > k", DECLARED + "param k = 4\n") == (
        Node("bool", value="b"),
        Node("signal", value="x"),
        Node("const", value=4.0),
        Node("gt", (1, 2)),
        Node("and", (0, 3)),
    )


def test_a_requirement_keeps_its_text_on_one_line_without_comments():
    text = "signal x\nhard a: always[0, 5]  # all the time\n   (x > 1 // far\n )"
    (requirement,) = compile_source(SourceText.of("s", text)).requirements
    assert requirement.text == "always[0, 5] (x > 1 )"


def test_a_header_arrives_in_the_requirement():
    text = 'signal x\nhard z: x > 0\nsoft a "doc" depends on z, z scale 2 bound linear: x > 1'
    requirement = compile_source(SourceText.of("s", text)).requirements[1]
    assert (requirement.strength, requirement.doc, requirement.depends_on) == ("soft", "doc", ("z",))
    assert (requirement.scale, requirement.bound) == (2.0, "linear")


def test_names_of_lets_point_at_their_nodes():
    bundle = compile_source(SourceText.of("s", "signal x\nlet p = x > 1\nlet unused = x > 2\nhard a: always p"))
    assert {name: bundle.nodes[i].op for name, i in bundle.names.items()} == {"p": "gt"}


@pytest.mark.parametrize("formula", ["now >= 700 ms", "700 ms <= 0.7 s + 0 * now", "0.7 s >= 700 ms"])
def test_a_time_in_another_unit_is_the_same_time(formula):
    result = api.compile(f"time s\nhard a: always[0.7 s, 0.7 s] ({formula})").evaluate({}, time=[0, 0.7])["a"]
    assert result.verdict.value == "satisfied"
