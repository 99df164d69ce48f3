"""Enclosures of robustness hold on every trace within the declared ranges."""

import random

import pytest

from stlspec.compiler.compiling import check_syntax, compile_source
from stlspec.compiler.lints.subject import make_subject
from stlspec.compiler.ranges import INF, TIE
from stlspec.lang.using import parse_with_uses
from stlspec.source import SourceText
from tests.compiler.lints.specs import oracle_of, random_spec, random_trace


def subject_of(text):
    syntax = parse_with_uses(SourceText.of("s", text), None)
    return make_subject(syntax, check_syntax(syntax).model)


@pytest.mark.parametrize(
    ("formula", "low", "high"),
    [
        ("always (x > 2)", -2, 8),
        ("always[1, 2] (x > 2)", -2, INF),
        ("eventually[1, 2] (x > 2)", -INF, 8),
        ("x > 2 and x < 5", -5, 5),
        ("x > 2 or x < 5", -2, 8),
        ("next (x > 2)", -INF, 8),
        ("p until (x > 2)", -2, 8),
        ("not (x > 2)", -8, 2),
    ],
)
def test_an_enclosure_is_that_worked_out_by_hand(formula, low, high):
    text = f"signal x in [0, 10]\nsignal p: bool\nhard a: {formula}\n"
    subject = subject_of(text)
    assert subject.truths[subject.sketch.roots["a"]] == (low, high)


def test_robustness_lies_in_its_enclosure_at_every_sample():
    rng = random.Random(5)
    for _ in range(150):
        text = random_spec(rng)
        bundle = compile_source(SourceText.of("s", text))
        subject = subject_of(text)
        for _ in range(4):
            oracle = oracle_of(bundle, random_trace(rng))
            for requirement in bundle.requirements:
                low, high = subject.truths[subject.sketch.roots[requirement.name]]
                assert all(low - TIE <= rho <= high + TIE for rho in oracle.rho(requirement.root)), text
