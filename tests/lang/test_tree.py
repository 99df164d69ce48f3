"""How texts are read: precedence, associativity, aliases, words that are names, units, comments, line ends."""

import pytest

from stlspec.lang.nodes import (
    DataFile,
    LabelExpectation,
    LetStatement,
    ParamStatement,
    RankExpectation,
    RequirementStatement,
    SignalStatement,
    SpecStatement,
    UseStatement,
    VerdictExpectation,
)
from stlspec.lang.parse import parse, parse_formula
from stlspec.lang.tree import OPERATORS, TreeBuilder
from stlspec.source import SourceText, Span
from tests.lang.sexpr import sexpr


def read(text, names=""):
    node, problems = parse_formula(SourceText.of("f", text), frozenset(names.split()))
    assert problems == (), [p.message for p in problems]
    return sexpr(node)


PRECEDENCE = [
    # Tightest first: call and index, power, minus, product, sum, comparison, prefix, until, and, xor, or, ...
    ("abs(x) ** 2", "(** (call abs x) 2)"),
    ("x[t] ** 2", "(** (index x t) 2)"),
    ("-abs(x)", "(neg (call abs x))"),
    ("2 ** 3 ** 2", "(** 2 (** 3 2))"),
    ("-x ** 2", "(neg (** x 2))"),
    ("x ** -2", "(** x (neg 2))"),
    ("x ** -y ** 2", "(** x (neg (** y 2)))"),
    ("--x", "(neg (neg x))"),
    ("-x * y", "(* (neg x) y)"),
    ("x * -y", "(* x (neg y))"),
    ("x * y ** 2", "(* x (** y 2))"),
    ("x / y / z", "(/ (/ x y) z)"),
    ("x / y * z", "(* (/ x y) z)"),
    ("x + y * z", "(+ x (* y z))"),
    ("x - y - z", "(- (- x y) z)"),
    ("x - y + z", "(+ (- x y) z)"),
    ("x - -y", "(- x (neg y))"),
    ("(x + y) * z", "(* (+ x y) z)"),
    ("x + 1 > y - 1", "(> (+ x 1) (- y 1))"),
    ("0 <= x < 5", "(chain 0 <= x < 5)"),
    ("0 < x < y < 5", "(< 0 x y 5)"),
    ("x <-1", "(< x (neg 1))"),
    ("not x > 5", "(not (> x 5))"),
    ("not not p", "(not (not p))"),
    ("always x > 5 and p", "(and (always (> x 5)) p)"),
    ("always not x > 5", "(always (not (> x 5)))"),
    ("not always p", "(not (always p))"),
    ("always eventually p", "(always (eventually p))"),
    ("always[0, 2] eventually[1, 3] p", "(always[0 2] (eventually[1 3] p))"),
    ("always (x > 5, 3)", None),
    ("always x + 1 > 5", "(always (> (+ x 1) 5))"),
    ("p until q and r", "(and (until p q) r)"),
    ("p and q until r", "(and p (until q r))"),
    ("not p until q", "(until (not p) q)"),
    ("always p until q", "(until (always p) q)"),
    ("p until always q", "(until p (always q))"),
    ("p until[1, 2] x > 3", "(until[1 2] p (> x 3))"),
    ("(p until q) until r", "(until (until p q) r)"),
    ("p until (q until r)", "(until p (until q r))"),
    ("p until q since r", "(chain p until q since r)"),
    ("p and q and r", "(and p q r)"),
    ("p or q and r", "(or p (and q r))"),
    ("p and q or r", "(or (and p q) r)"),
    ("p xor q and r", "(xor p (and q r))"),
    ("p and q xor r", "(xor (and p q) r)"),
    ("p or q xor r", "(or p (xor q r))"),
    ("p xor q xor r", "(xor p q r)"),
    ("p or q or r", "(or p q r)"),
    ("p implies q or r", "(implies p (or q r))"),
    ("p or q implies r", "(implies (or p q) r)"),
    ("p implies q implies r", "(implies p (implies q r))"),
    ("(p implies q) implies r", "(implies (implies p q) r)"),
    ("p iff q implies r", "(iff p (implies q r))"),
    ("p implies q iff r", "(iff (implies p q) r)"),
    ("p iff q iff r", "(iff p q r)"),
    ("always p implies q", "(implies (always p) q)"),
    ("always (p implies q)", "(always (implies p q))"),
    ("true and false", "(and true false)"),
    ("x > -inf", "(> x (neg inf))"),
    ("min(x, y + 1, z) > 0", "(> (call min x (+ y 1) z) 0)"),
    ("x = 5", "(= x 5)"),
    ("always[T - 1, 2 * T] p", "(always[(- T 1) (* 2 T)] p)"),
    ("always (x) > 5", "(always (> x 5))"),
]

ALIASES = [
    ("G p", "(always p)"), ("globally p", "(always p)"), ("alw p", "(always p)"), ("alw_[0, 5] p", "(always[0 5] p)"),
    ("G[0, 5] p", "(always[0 5] p)"), ("F p", "(eventually p)"), ("finally p", "(eventually p)"),
    ("ev p", "(eventually p)"), ("ev_[0, 5] p", "(eventually[0 5] p)"), ("H p", "(historically p)"),
    ("hist p", "(historically p)"), ("hist_[0, 5] p", "(historically[0 5] p)"), ("O p", "(once p)"),
    ("once_[0, 5] p", "(once[0 5] p)"), ("X p", "(next p)"), ("next p", "(next p)"), ("wnext p", "(wnext p)"),
    ("Y p", "(prev p)"), ("prev p", "(prev p)"), ("wprev p", "(wprev p)"), ("p U q", "(until p q)"),
    ("p until_[0, 5] q", "(until[0 5] p q)"), ("p U[0, 5] q", "(until[0 5] p q)"), ("p W q", "(unless p q)"),
    ("p unless q", "(unless p q)"), ("p R q", "(release p q)"), ("p release[1, 2] q", "(release[1 2] p q)"),
    ("p S q", "(since p q)"), ("p since_[0, 5] q", "(since[0 5] p q)"), ("p since q", "(since p q)"),
    ("!p", "(not p)"), ("! p & q", "(and (not p) q)"), ("p & q && r", "(and p q r)"), ("p | q || r", "(or p q r)"),
    ("p -> q", "(implies p q)"), ("p => q", "(implies p q)"), ("p <-> q", "(iff p q)"), ("p <=> q", "(iff p q)"),
    ("always[0:5] p", "(always[0 5] p)"), ("always[0, inf] p", "(always[0 inf] p)"), ("x==y", "(== x y)"),
    ("x != y", "(!= x y)"), ("G F p", "(always (eventually p))"), ("G X p", "(always (next p))"),
    ("G wnext p", "(always (wnext p))"), ("F wprev p", "(eventually (wprev p))"), ("G(p)", "(always p)"),
    ("F[0, 2] G[1, 3] p", "(eventually[0 2] (always[1 3] p))"), ("G !p", "(always (not p))"),
    ("G -x > 2", "(always (> (neg x) 2))"), ("G true", "(always true)"),
]  # fmt: skip

WORDS = [
    # Declared words are names; undeclared one-letter words are operators where one fits and an operand follows.
    ("time > 3", "time", "(> time 3)"),
    ("scale > 3", "scale", "(> scale 3)"),
    ("G > 3", "G", "(> G 3)"),
    ("G G > 3", "G", None),
    ("always G > 3", "G", "(always (> G 3))"),
    ("U > 3 and S < 2", "U S", "(and (> U 3) (< S 2))"),
    ("p and S", "S", "(and p S)"),
    ("on and unit and in", "on unit in", "(and on unit in)"),
    ("S > 3", "", "(> S 3)"),
    ("G > 3", "", "(> G 3)"),
    ("G", "", "G"),
    ("G and p", "", "(and G p)"),
    ("p and G", "", "(and p G)"),
    ("G_foo > 3", "", "(> G_foo 3)"),
    ("alw > 1", "", "(> alw 1)"),
    ("W + U > 1", "W U", "(> (+ W U) 1)"),
    ("p U X q", "", "(until p (next q))"),
    ("5 W y", "", "(unless 5 y)"),
    ("5 W y > 1", "W", None),
    ("x > 5 S", "", "(> x 5_S)"),
    ("x > 5 W", "W", "(> x 5_W)"),
    ("x > 5 F", "", "(> x 5_F)"),
    ("x > 5 min", "", "(> x 5_min)"),
    ("x > 5 in", "", "(> x 5_in)"),
    ("x > 3 m/s", "", "(> x 3_m/s)"),
    ("x > 3 m / s", "s", "(> x (/ 3_m s))"),
    ("x > 10 m/v", "v", "(> x (/ 10_m v))"),
    ("x > 3 m/s**2", "", "(> x 3_m/s**2)"),
    ("x > 3 m**2", "", "(> x 3_m**2)"),
    ("x > 5 s and p", "", "(and (> x 5_s) p)"),
    ("x > 5\nand p", "", "(and (> x 5) p)"),
    ("spec and use and from", "", "(and spec use from)"),
    ("depends and bound", "", "(and depends bound)"),
    ("t > 1 and now > 2", "", "(and (> t 1) (> now 2))"),
    ("always_on", "", "always_on"),
]

LAYOUT = [
    ("x > 1 # a comment\nand p", "(and (> x 1) p)"),
    ("x > 1 // a comment\nand p", "(and (> x 1) p)"),
    ("x > 1 # a comment\r\nand p", "(and (> x 1) p)"),
    ("x > 1 # a comment\rand p", "(and (> x 1) p)"),
    ("\ufeffx > 1", "(> x 1)"),
    ("x\n>\n1\n", "(> x 1)"),
    ("x\t>\f1", "(> x 1)"),
    ("x>1&p", "(and (> x 1) p)"),
    ("x > .5e-1", "(> x 0.05)"),
    ("x > 5.", "(> x 5)"),
    ("a//b", "a"),
]


@pytest.mark.parametrize(("text", "expected"), PRECEDENCE)
def test_precedence_and_associativity_are_those_of_the_reference(text, expected):
    if expected is None:
        assert parse_formula(SourceText.of("f", text), frozenset())[1]
    else:
        assert read(text) == expected


@pytest.mark.parametrize(("text", "expected"), ALIASES)
def test_every_alias_reads_as_its_canonical_word(text, expected):
    assert read(text) == expected


@pytest.mark.parametrize(("text", "names", "expected"), WORDS)
def test_a_word_is_a_name_where_it_is_declared_or_nothing_else_fits(text, names, expected):
    if expected is None:
        assert parse_formula(SourceText.of("f", text), frozenset(names.split()))[1]
    else:
        assert read(text, names) == expected


@pytest.mark.parametrize(("text", "expected"), LAYOUT)
def test_comments_blanks_and_line_ends_change_nothing(text, expected):
    assert read(text) == expected


def test_a_let_with_a_second_equals_sign_is_read_as_a_comparison():
    (let,) = parse(SourceText.of("s", "let p = x = 5")).statements
    assert isinstance(let, LetStatement)
    assert sexpr(let.body) == "(= x 5)"


def test_an_argument_of_a_let_is_a_name_in_its_body():
    (let,) = parse(SourceText.of("s", "let p(G, x) = G > x")).statements
    assert [a.text for a in let.arguments] == ["G", "x"]
    assert sexpr(let.body) == "(> G x)"


def test_every_part_of_a_header_is_kept_in_any_order():
    text = 'hard a scale 2.5 "doc" bound linear depends on b, c: x > 1'
    (hard,) = parse(SourceText.of("s", text)).statements
    assert isinstance(hard, RequirementStatement)
    assert (hard.strength, hard.name.text, hard.doc.text, hard.scale.value, hard.bound.text) == (
        "hard",
        "a",
        "doc",
        2.5,
        "linear",
    )
    assert [n.text for n in hard.depends_on] == ["b", "c"]
    assert sexpr(hard.formula) == "(> x 1)"


def test_every_part_of_a_signal_is_kept_in_any_order():
    text = 'signal v "speed" from "obs.v[0]" in [-1.5, 2 * T] unit "m/s": real'
    (signal,) = parse(SourceText.of("s", text)).statements
    assert isinstance(signal, SignalStatement)
    assert (signal.doc.text, signal.source.text, signal.unit.text, signal.type.text) == (
        "speed",
        "obs.v[0]",
        "m/s",
        "real",
    )
    assert (sexpr(signal.range.low), sexpr(signal.range.high)) == ("(neg 1.5)", "(* 2 T)")


@pytest.mark.parametrize(
    ("text", "value", "unit", "doc"),
    [
        ("param T", None, None, None),
        ('param T "doc"', None, None, "doc"),
        ("param T = 8", 8, None, None),
        ('param T = -8.5 s "doc"', -8.5, "s", "doc"),
    ],
)
def test_a_param_has_an_optional_value_unit_and_doc(text, value, unit, doc):
    (param,) = parse(SourceText.of("s", text)).statements
    assert isinstance(param, ParamStatement)
    number = param.number
    assert (number and number.value, number and number.unit and number.unit.text) == (value, unit)
    assert (param.doc.text if param.doc else None) == doc


def test_the_first_of_two_equal_clauses_counts_and_the_second_is_kept_apart():
    (hard,) = parse(SourceText.of("s", "hard a scale 1 scale 2: x > 1")).statements
    assert hard.scale.value == 1
    assert [c.text for c in hard.repeated] == ["scale"]


def test_spans_cover_exactly_the_text_of_each_node():
    source = SourceText.of("f", " always[0, 5 s] (x + 1) > 2 and  p ")
    node, _ = parse_formula(source, frozenset())
    always = node.operands[0]
    assert source.slice(node.span) == "always[0, 5 s] (x + 1) > 2 and  p"
    assert source.slice(always.span) == "always[0, 5 s] (x + 1) > 2"
    assert source.slice(always.operator.span) == "always"
    assert source.slice(always.operator.interval.span) == "[0, 5 s]"
    assert source.slice(always.operator.interval.high.span) == "5 s"
    assert source.slice(always.operand.operands[0].span) == "(x + 1)"


def test_the_spec_statement_has_a_name_and_a_title():
    (spec,) = parse(SourceText.of("s", 'spec grid "A # title"')).statements
    assert isinstance(spec, SpecStatement)
    assert (spec.name.text, spec.title.text, spec.span) == ("grid", "A # title", Span(0, 21))


def one(text):
    syntax = parse(SourceText.of("s", text))
    assert syntax.diagnostics == ()
    (statement,) = syntax.statements
    return statement


def test_a_use_statement_has_the_path_as_written():
    statement = one('use "../shared/signals.stl"')
    assert isinstance(statement, UseStatement) and statement.path.text == "../shared/signals.stl"


def test_an_expectation_of_a_verdict_has_data_sample_and_margin_in_any_order():
    for clauses in ("at -1 margin >= 0.5", "margin >= .5 at -1"):
        found = one(f'expect avoid fails on "d1.csv" episode 3\n {clauses}')
        assert isinstance(found, VerdictExpectation)
        assert (found.requirement.text, found.verdict.text) == ("avoid", "fails")
        assert (found.data.path.text, found.data.episode.value) == ("d1.csv", 3)
        assert (found.at.value, found.margin.value) == (-1, 0.5)


def test_data_in_a_spec_keeps_signs_infinities_and_truth_values():
    found = one("expect a holds on {x: [2, -1.5, inf, -inf],\n time: [0,\n 1], on: [true, false]}")
    columns = {c.name.text: [s.value for s in c.samples] for c in found.data.columns}
    assert columns == {"x": [2, -1.5, float("inf"), -float("inf")], "time": [0, 1], "on": [True, False]}
    assert (found.at, found.margin) == (None, None)


def test_labels_and_ranks_are_expected_of_files_or_of_one_episode_in_them():
    label = one('expect "d.jsonl" episode "a detour" is incomplete')
    assert isinstance(label, LabelExpectation)
    assert (label.data.path.text, label.data.episode.text, label.label.text) == ("d.jsonl", "a detour", "incomplete")
    rank = one('expect "a.csv" outranks\n "b.csv" episode 0')
    assert isinstance(rank, RankExpectation) and isinstance(rank.better, DataFile)
    assert (rank.better.path.text, rank.worse.path.text, rank.worse.episode.value) == ("a.csv", "b.csv", 0)


@pytest.mark.parametrize("word", "holds fails on episode at margin is outranks".split())
def test_the_words_of_expectations_are_names_everywhere_else(word):
    text = f'signal {word}\nhard {word}_ok: {word} > {word} + 1\nexpect {word} holds on "f" at 1'
    syntax = parse(SourceText.of("s", text))
    assert syntax.diagnostics == () and syntax.statements[2].requirement.text == word


def test_the_builder_has_a_callback_for_every_operator_and_no_other_name():
    builder = TreeBuilder()
    assert all(callable(getattr(builder, rule)) for rule in OPERATORS)
    with pytest.raises(AttributeError):
        builder.no_such_rule  # noqa: B018
