"""What is written reads back as the same tree, whatever brackets that takes."""

import random

from stlspec.lang.nodes import Group, Infix, Number, Operator, Prefix, RequirementStatement, Truth
from stlspec.lang.parse import parse_formula
from stlspec.source import SourceText, Span
from stlspec.tools.importing.formulas import bare
from stlspec.tools.importing.rtamt import read
from stlspec.tools.importing.writing import expression_text, spec_text
from tests.lang.sexpr import sexpr

AT = Span(0, 0)


def number(rng, depth):
    if not depth:
        return Number(AT, float(rng.choice([1, 2, -3])), None)
    if rng.random() < 0.2:
        return Prefix(AT, Operator(AT, "neg"), number(rng, depth - 1))
    word = rng.choice(["add", "sub", "mul", "div", "pow"])
    return Infix(AT, (Operator(AT, word),), (number(rng, depth - 1), number(rng, depth - 1)))


def formula(rng, depth):
    if not depth:
        return rng.choice([Truth(AT, True), Infix(AT, (Operator(AT, "lt"),), (number(rng, 2), number(rng, 1)))])
    if rng.random() < 0.4:
        return Prefix(AT, Operator(AT, rng.choice(["not", "always", "wnext"])), formula(rng, depth - 1))
    word = rng.choice(["and", "or", "implies", "until", "iff", "xor", "unless"])
    return Infix(AT, (Operator(AT, word),), (formula(rng, depth - 1), formula(rng, depth - 1)))


def same(node):
    """The tree as an S-expression, a negative number as its negation, as the language reads it."""
    return sexpr(node).replace("-3", "(neg 3)")


def test_random_trees_read_back_as_they_were():
    rng = random.Random(1)
    for _ in range(500):
        tree = formula(rng, rng.randint(0, 4))
        text = expression_text(tree)
        back, problems = parse_formula(SourceText.of("f", text))
        assert problems == () and same(bare(back)) == same(tree), text
        assert not isinstance(back, Group)


def test_comments_stand_before_what_they_are_about():
    text = "// first\nfloat x // of x\n/* two\n lines */\nout = x > 1\n// last"
    draft = read(SourceText.of("f", text))
    written = spec_text(draft.statements(), draft.comments)
    assert written == ("time 1 s\n\n# first\n# of x\nsignal x\n\n# two\n# lines\nhard out:\n    x > 1\n\n# last\n")
    assert isinstance(draft.statements()[-1], RequirementStatement)
