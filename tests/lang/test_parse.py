"""Statement by statement: one diagnostic for each broken one, neighbours intact, no text that breaks the parser."""

import random
import time

import pytest

from stlspec.compiler.compiling import check_source, compile_source
from stlspec.errors import SpecError
from stlspec.lang.nodes import Number, post_order
from stlspec.lang.parse import DEEPEST, following, parse, parse_formula, tokens_of
from stlspec.source import SourceText
from tests.lang.generate import disagreement
from tests.lang.mutate import run
from tests.lang.soup import fault, soup


def codes(text):
    return [d.code for d in parse(SourceText.of("s", text)).diagnostics]


def lines(text):
    return [d.source.position(d.span.start).line for d in parse(SourceText.of("s", text)).diagnostics]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("signal x\nhrad a: x > 1\nsignal y", ["S003"]),
        ("signal x\nlet p = (x > 1\nhard a: p", ["S004"]),
        ("signal x\nhard a: always[0, 5 (x > 1)\nhard b: x > 2", ["S004"]),
        ("hard a: x > 1 and\nhard b: x > 2", ["S002"]),
        ("hard a: x >\n\n\nhard b: y >", ["S002", "S002"]),
        ("signal x signal y", ["S011"]),
        ('signal x "open\nsignal y', ["S006"]),
        ("hard a: x > 1\ntime = 5", ["S001"]),
        ("let p = x and\n time > 3", []),
        ("let p = x\n time > 3", ["S001"]),
        ("spec a\nspec\nsignal x", ["S002"]),
        ("expect a fails on {x: [1, 2]}\n  at 0", []),
        ("", ["S016"]),
        ("# nothing\n", ["S016"]),
        ("hard a scale 1 scale 2 bound tanh bound none: x > 1", ["S020", "S020"]),
        # Two broken ones in a row stay two, even where the second lost its first word.
        ("param a = = 3\nparma b = 4\nsignal x", ["S001", "S003"]),
        ("let p = x and\n  hrad a: x > 1", ["S002", "S003"]),
        ("signal ]\n) signal y\n", ["S019", "S019"]),
    ],
)
def test_each_broken_statement_gives_one_diagnostic(text, expected):
    assert codes(text) == expected


def test_two_broken_statements_far_apart_leave_all_others_whole():
    good = "".join(f"hard r{i}: always (x > {i})\n" for i in range(50))
    syntax = parse(SourceText.of("s", "signal x 1\n" + good + "hard z: x > > 1\n" + good.replace("hard r", "hard q")))
    assert [d.code for d in syntax.diagnostics] == ["S001", "S001"]
    assert len(syntax.statements) == 100
    assert {"x", "z"} <= syntax.names | syntax.requirement_names


def test_a_statement_that_is_cut_off_is_reported_at_the_end_of_its_last_token():
    (problem,) = parse(SourceText.of("s", "signal x\nhard a: x > 1 and   # more\n\n\nsignal y")).diagnostics
    assert problem.source.position(problem.span.start).line == 2
    assert problem.source.slice(problem.span) == ""
    assert problem.source.text[: problem.span.start].endswith("and")


def test_a_statement_begins_at_a_reserved_word_first_on_its_line_only():
    text = "hard a: (x > 1\n  signal y\nlet p = y > (2\n) and 3 hard"
    assert lines(text) == [1, 4]


def test_line_ends_of_all_kinds_count_as_lines():
    assert lines("signal x\r\nsignal 1\r\nsignal y") == [2]
    assert lines("signal x # comment\rsignal 1\rsignal y") == [2]


def test_comments_are_kept_with_their_place():
    source = SourceText.of("s", "signal x # one\n// two\nhard a: x > 1")
    assert [(c.text, source.slice(c.span)) for c in parse(source).comments] == [
        ("# one", "# one"),
        ("// two", "// two"),
    ]


def test_a_formula_alone_is_parsed_or_diagnosed_once():
    node, problems = parse_formula(SourceText.of("f", "always (x > "), frozenset())
    assert node is None
    assert [p.code for p in problems] == ["S002"]
    assert [p.code for p in parse_formula(SourceText.of("f", ""), frozenset())[1]] == ["S016"]


def test_random_trees_are_read_back_as_they_were_written():
    rng = random.Random(1)
    assert [found for found in (disagreement(rng) for _ in range(2000)) if found] == []


def test_texts_without_sense_never_break_the_checker_and_cost_little():
    def seconds(text: str) -> float:
        before = time.process_time()
        assert fault(text) is None, text
        return time.process_time() - before

    rng = random.Random(1)
    # A slow text is slow every time; a pause of the machine or of the garbage collector is not.
    slow = [text for text in (soup(rng) for _ in range(3000)) if seconds(text) >= 0.05]
    assert [text for text in slow if min(seconds(text) for _ in range(5)) >= 0.05] == []


def test_broken_statements_are_found_where_they_are_and_nothing_else_is_blamed():
    counts = run(cases=150, seed=3)
    assert counts.broken >= 150
    assert counts.found >= 0.99 * counts.broken
    assert counts.placed >= 0.98 * counts.broken
    assert counts.diagnostics <= 1.05 * counts.broken
    assert counts.blamed <= 0.01 * counts.good


@pytest.mark.parametrize(
    "level",
    ["(", "not ", "-", "!", "always ", "always(", "abs(", "x[", "always[0, (", "p implies ", "p until ", "2 ** ", "G "],
)
def test_deep_nesting_is_one_diagnostic_and_costs_less_than_a_second(level):
    before = time.process_time()
    result = check_source(SourceText.of("s", "signal x\nsignal p: bool\nhard a: " + level * 10_000 + "p\nhard b: p"))
    assert [d.code for d in result.diagnostics] == (["S009"] if level == "p until " else ["S007"])
    assert time.process_time() - before < 1


@pytest.mark.parametrize("level", ["(", "not ", "-", "always "])
def test_nesting_up_to_the_limit_compiles(level):
    inner = {"(": "x > 1", "-": "x > 1"}.get(level, "(x > 1)")
    closing = ")" if level == "(" else ""
    for depth, fits in ((DEEPEST - 1, True), (DEEPEST + 1, False)):
        text = f"signal x\nhard a: {level * depth}{inner}{closing * depth}"
        found = [d.code for d in check_source(SourceText.of("s", text)).diagnostics]
        assert found == ([] if fits else ["S007"])


def test_nesting_inside_bounds_and_indices_counts_too():
    for text in ("hard a: always[0, " + "-" * 300 + "1] x > 1", "signal y in [" + "-" * 300 + "1, 5]"):
        assert codes("signal x\n" + text) == ["S007"]


@pytest.mark.parametrize("operator", ["and", "or", "xor", "+", "*", "-", "/", "<", "<="])
def test_flat_chains_of_ten_thousand_compile(operator):
    arithmetic = operator in "+*-/<="
    body = f" {operator} ".join(["x" if arithmetic else "x > 1"] * 10_000)
    suffix = " > 1" if operator in "+*-/" else ""
    bundle = compile_source(SourceText.of("s", f"signal x\nhard a: {body}{suffix}"))
    assert len(bundle.nodes) >= 2


def test_a_thousand_lets_each_using_the_one_before_compile():
    lets = "".join(f"let p{i} = p{i - 1} or x > {i} and p{i - 1}\n" for i in range(1, 1000))
    bundle = compile_source(SourceText.of("s", f"signal x\nlet p0 = x > 0\n{lets}hard a: always p999"))
    assert len(bundle.nodes) < 6000


def test_ten_thousand_requirements_cost_about_ten_times_a_thousand():
    def cost(n):
        text = "signal x\n" + "".join(f"hard r{i}: always[0, {i}] (x > {i})\n" for i in range(n))
        before = time.process_time()
        compile_source(SourceText.of("s", text))
        return time.process_time() - before

    cost(100)
    assert cost(10_000) <= 20 * max(cost(1000), cost(1000))


def test_many_unknown_names_do_not_cost_the_square_of_the_text():
    names = "".join(f"signal signal_number_{i}\n" for i in range(2000))
    uses = "".join(f"hard a{i}: signal_nmber_{i} > 1\n" for i in range(2000))
    before = time.process_time()
    assert len(check_source(SourceText.of("s", names + uses)).diagnostics) == 2000
    assert time.process_time() - before < 5


def test_a_spec_with_errors_carries_all_of_them_in_order():
    with pytest.raises(SpecError) as caught:
        compile_source(SourceText.of("s", "signal x\nhard a: x\nhard b: y > 1\nhrad c"))
    assert [d.code for d in caught.value.diagnostics] == ["T201", "N101", "S003"]


@pytest.mark.parametrize(
    ("text", "fits", "not_"),
    [
        ("", {"SIGNAL", "TIME"}, {"NAME", "$END"}),
        ("signal x", {"COLON", "UNIT_WORD", "IN", "FROM", "STRING", "$END"}, {"NAME", "AND"}),
        ("hard a depends on", {"NAME"}, {"NOT", "NUMBER"}),
        ("hard a:", {"NAME", "NOT", "ALWAYS", "NUMBER", "LPAR"}, {"AND", "$END"}),
        ("hard a: G", {"LSQB", "NAME", "NOT"}, {"AND", "$END"}),
        ("let G = x\nhard a: G".splitlines()[1], {"LSQB"}, {"AND"}),
        ("hard a: x > 5", {"UNIT", "AND", "PLUS", "$END"}, {"NOT"}),
        ("hard a: x U", {"NAME", "NOT", "LSQB"}, {"AND"}),
        ("hard a: (x > 1", {"RPAR", "AND"}, {"$END"}),
        ("hard a: (x >> 1", set(), {"NAME", "$END"}),
        ("expect a", {"HOLDS", "FAILS"}, {"NAME"}),
    ],
)
def test_what_fits_behind_the_beginning_of_a_statement(text, fits, not_):
    found = following(tokens_of(SourceText.of("s", text)), frozenset())
    assert fits <= found
    assert not found & not_


def test_a_declared_alias_is_a_name_where_it_is_typed():
    tokens = tokens_of(SourceText.of("s", "hard a: G"))
    assert "AND" in following(tokens, frozenset({"G"}))


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("x > 120 mg/dL", "mg/dL"),
        ("x > 120 mg/dL**2 and x < 3", "mg/dL**2"),
        ("x > 3 m/k", "m"),
        ("x > 3 m/now", "m"),
        ("x > 3 m/abs(x)", "m"),
        ("x > 3 m/ dL", "m"),
    ],
)
def test_a_unit_takes_what_is_glued_to_it_and_is_no_name(text, unit):
    syntax = parse(SourceText.of("s", f"signal x\nparam k = 2\nhard a: {text}\n"))
    (number,) = [n for s in syntax.statements[2:] for n in post_order(s.formula) if isinstance(n, Number) and n.unit]
    assert number.unit.text == unit
