"""Templates: lets with arguments mean what they would mean written out, and say at the call what does not fit."""

import random
import time

import pytest

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.compiling import check_source, compile_source
from stlspec.source import SourceText

HEAD = 'signal x unit "m"\nsignal y unit "m"\nsignal b: bool\nparam r = 2 m\nparam n = 3\n'


def meaning(text, params=None):
    return meaning_sha256(compile_source(SourceText.of("s", HEAD + text), params))


def problems(text):
    return check_source(SourceText.of("s", HEAD + text)).diagnostics


def said(text):
    """Code and text of the place of each diagnostic."""
    return [(p.code, p.source.slice(p.span)) for p in problems(text)]


@pytest.mark.parametrize(
    ("template", "call", "written"),
    [
        ("let near(p, d) = p < d", "near(x, 3 m)", "x < 3 m"),
        ("let near(p, d) = p < d", "near(x + y, r)", "x + y < r"),
        ("let soon(p, k) = eventually[0, k] p", "soon(b, 5)", "eventually[0, 5] b"),
        ("let soon(p, k) = eventually[0, k] p", "soon(b, 2 * n)", "eventually[0, 2 * n] b"),
        (
            "let soon(p, k) = eventually[k, 2 * k + 1] p",
            "soon(soon(b, 1), n)",
            "eventually[n, 2*n+1] eventually[1, 3] b",
        ),
        ("let f(p, q) = p until q", "f(b or x > r, always b)", "(b or x > r) until (always b)"),
        ("let twice(p) = 2 * p", "twice(x + 1 m) > r", "2 * (x + 1 m) > r"),
        ("let f(p) = p[t] > 1 m", "f(y)", "y > 1 m"),
        ("let f(x) = x > 1 m", "f(y)", "y > 1 m"),
        ("let f(y) = x > y", "f(y + x)", "x > y + x"),
        ("let g(p) = p and b\nlet f(p, q) = g(q) or g(p)", "f(x > r, not b)", "(not b and b) or (x > r and b)"),
        ("let f(b) = b", "f(true)", "true"),
        ("let f(k) = always[0, k] b", "f(inf)", "always b"),
        ("let min(p) = p", "min(b)", "b"),
        ("let h(p) = q(p)\nlet q(p) = not p", "h(q(b))", "not not b"),
    ],
)
def test_a_template_means_what_it_means_written_out(template, call, written):
    head = 'signal u unit "cm"\n'
    assert meaning(f"{head}{template}\nhard a: {call}") == meaning(f"{head}hard a: {written}")


def test_an_argument_is_understood_where_the_call_stands():
    # In `f`, y is the argument; in the call, y is the signal: nothing is caught.
    assert meaning("let f(y, k) = x > y and k\nhard a: f(r, y > 1 m)") == meaning("hard a: x > r and y > 1 m")
    assert meaning("let g(x) = x > y\nlet f(y) = g(y)\nhard a: f(r)") == meaning("hard a: r > y")


def test_templates_are_written_out_for_each_unit():
    text = 'signal d unit "ms"\nsignal e unit "s"\nlet late(p) = p > 2 s\nhard a: late(d) or late(e)'
    assert meaning(text) == meaning('signal d unit "ms"\nsignal e unit "s"\nhard a: d > 2 s or e > 2 s')


def test_params_in_arguments_are_bound_from_outside():
    text = "let soon(p, k) = eventually[0, k] p\nhard a: soon(b, n + 1)"
    assert meaning(text, {"n": 7}) == meaning("hard a: eventually[0, 8] b", {"n": 7})
    assert said("param open\nlet soon(p, k) = eventually[0, k] p\nhard a: soon(b, open)") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("let f(p, q) = p < q\nhard a: f(x)", ("N113", "f(x)")),
        ("let f(p, q) = p < q\nhard a: f(x, r, r)", ("N113", "f(x, r, r)")),
        ("let f(p) = p < r\nhard a: b and f", ("N113", "f")),
        ("let f(p, q) = p < q\nhard a: f(q = r, p = y + z)", ("N113", "f(q = r, p = y + z)")),
        ("let f(p) = p < r\nhard a: always f[t]", ("N113", "f")),
        ("let f = x < r\nhard a: f(x)", ("N103", "f")),
        ("let f(g) = g(x) > r\nhard a: b", ("N103", "g")),
        ("let f(p, p) = p < r\nhard a: b", ("N114", "p")),
        ("let f(p) = p < r\nhard a: f(b)", ("T202", "b")),
        ("let f(p) = p < r\nhard a: f(3 s)", ("U301", "f(3 s)")),
        ("let f(p) = always p\nhard a: f(x + y)", ("T201", "x + y")),
        ("let f(p, k) = always[0, k] p\nhard a: f(b, x)", ("T204", "x")),
        ("let f(p, k) = always[0, k] p\nhard a: f(b, -1)", ("I402", "-1")),
        ("let f(k) = always[k, 5] b\nhard a: f(2 * n)", ("I401", "f(2 * n)")),
        ("let f(p) = p < z\nhard a: b", ("N101", "z")),
        ("let f(p) = p and 3\nhard a: f(b)", ("T201", "3")),
        ("let f(p) = f(p)\nhard a: b", ("N104", "f")),
        ("let f(p) = g(p)\nlet g(p) = b and f(p)\nhard a: b", None),
        ("let near(p) = p < r\nhard a: naer(x)", ("N103", "naer")),
    ],
)
def test_what_does_not_fit_is_one_diagnostic_at_the_call(text, expected):
    found = said(text)
    assert len(found) == 1
    assert found[0] == expected if expected else found[0][0] == "N104"


def test_an_error_in_a_call_shows_the_place_in_every_template_on_the_way():
    (problem,) = problems("let f(p) = p < r\nlet g(q) = always f(q)\nlet h(q) = g(q)\nhard a: h(b)")
    assert problem.source.slice(problem.span) == "b"
    assert [label.source.slice(label.span) for label in problem.labels] == ["q", "q", "p"]
    assert [label.text.split(":")[0] for label in problem.labels] == ["in `h`", "in `g`", "in `f`"]


def test_messages_name_the_argument_that_was_given():
    (problem,) = problems("let f(p) = always p\nhard a: f(x + y)")
    assert "`x + y > 0`" in problem.help


def test_two_uses_with_the_same_arguments_cost_no_more_than_one():
    lines = ["let t0(p) = p > r"] + [f"let t{i}(p) = t{i - 1}(p) and next t{i - 1}(p)" for i in range(1, 40)]
    found = compile_source(SourceText.of("s", HEAD + "\n".join([*lines, "hard a: t39(x)"])))
    assert len(found.nodes) < 100


def test_templates_that_explode_are_refused_once_and_soon():
    lines = ["let t0(p) = p > r"] + [f"let t{i}(p) = t{i - 1}(p + 1 m) and t{i - 1}(2 * p)" for i in range(1, 40)]
    before = time.perf_counter()
    assert [code for code, _ in said("\n".join([*lines, "hard a: t39(x)"]))] == ["N115"]
    assert time.perf_counter() - before < 30


def test_a_tower_of_templates_is_bounded_and_arguments_may_nest_deep():
    tower = ["let t0(p) = not p"] + [f"let t{i}(p) = t{i - 1}(p)" for i in range(1, 300)]
    assert said("\n".join([*tower, "hard a: t299(b)"])) == [("N115", "t50")]
    nested = "f(" * 150 + "b" + ")" * 150
    assert meaning(f"let f(p) = not p\nhard a: {nested}") == meaning("hard a: b")


def test_a_let_that_calls_templates_keeps_its_name_and_templates_have_none():
    found = compile_source(SourceText.of("s", HEAD + "let f(p) = p < r\nlet close = f(x)\nhard a: always close"))
    assert dict(found.names).keys() == {"close"}
    assert found.requirements[0].text == "always close"


def test_random_specs_mean_the_same_with_templates_and_written_out():
    rng = random.Random(5)

    def formula(depth, arguments):
        """The same formula with calls, and written out."""
        kind = rng.choice(["name", "and", "always", "not", "call"]) if depth else "name"
        if kind == "name":
            return rng.choice([("b", "b"), ("(x > r)", "(x > r)"), *arguments])
        left, right = formula(depth - 1, arguments), formula(depth - 1, arguments)
        if kind == "and":
            return tuple(f"({p} and {q})" for p, q in zip(left, right, strict=True))
        if kind == "always":
            return tuple(f"(always[0, n] {p})" for p in left)
        if kind == "not":
            return tuple(f"(not {p})" for p in left)
        return f"f({left[0]}, {right[0]})", f"(({left[1]}) or eventually[0, 2] ({right[1]}))"

    for _ in range(100):
        short, written = formula(5, [])
        template = "let f(p, q) = p or eventually[0, 2] q\n"
        assert meaning(f"{template}hard a: {short}") == meaning(f"hard a: {written}")


def test_a_fix_of_the_body_is_none_at_the_call():
    (problem,) = problems("let f(k) = always[k, 5] b\nhard a: f(9)")
    assert problem.code == "I401" and problem.fixes == ()
