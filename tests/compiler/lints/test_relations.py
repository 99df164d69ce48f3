"""What is said of pairs of requirements holds on every trace; what is certain is found."""

import random
import re

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.review import review_source
from stlspec.source import SourceText
from tests.compiler.lints.specs import oracle_of, random_spec, random_trace

HEAD = "signal x\nsignal p: bool\nsignal q: bool\n"


def codes(text, head=HEAD):
    found = review_source(SourceText.of("s", head + text)).diagnostics
    return [d.code for d in found if d.code in ("L605", "L606")]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("always (x > 5)", "always (x < 3)"),
        ("always (x > 5)", "eventually (x <= 5)"),
        ("always[0, 10] (x > 5)", "eventually[3, 8] (x < 3)"),
        ("always (x > 5 and p)", "always (q and x < 3)"),
        ("always (x == 1)", "always (x == 2)"),
        ("always p", "eventually not p"),
        ("always p", "not p"),
    ],
)
def test_contradictions_are_found(one, other):
    assert codes(f"hard a: {one}\nhard b: {other}\n") == ["L605"]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("always (x > 5)", "always (x < 6)"),
        ("always[5, 10] (x > 5)", "always[5, 10] (x < 3)"),  # a trace of two samples meets both
        ("always[0, 5] (x > 5)", "eventually (x < 3)"),
        ("eventually (x > 5)", "eventually (x < 3)"),
        ("always (x >= 5)", "always (x <= 5)"),
    ],
)
def test_what_can_hold_together_is_no_contradiction(one, other):
    assert codes(f"hard a: {one}\nhard b: {other}\n") == []


@pytest.mark.parametrize(
    ("strong", "weak"),
    [
        ("always[0, 10] p", "always[0, 5] p"),
        ("always (x > 5)", "always (x > 3)"),
        ("always (x > 5)", "eventually (x >= 5)"),
        ("always (p and q)", "always p"),
        ("eventually[0, 3] p", "eventually[0, 5] p"),
        ("always p", "always (p or q)"),
        ("always p", "always p"),
    ],
)
def test_what_a_hard_requirement_contains_is_found_in_either_order(strong, weak):
    assert codes(f"hard a: {strong}\nhard b: {weak}\n") == ["L606"]
    assert codes(f"hard b: {weak}\nhard a: {strong}\n") == ["L606"]


def test_steps_towards_a_stronger_requirement_are_not_reported():
    assert codes("hard b: always[0, 5] p\nhard a depends on b: always[0, 10] p\n") == []
    assert codes("soft b: eventually p\nsoft a: eventually[0, 5] p\n") == []


def test_a_thousand_requirements_are_judged_in_time():
    text = "".join(f"hard r{i}: always (x > {i})\n" for i in range(1000))
    assert codes(text) == []


def test_no_trace_contradicts_what_is_said():
    rng = random.Random(11)
    said = 0
    for _ in range(250):
        text = random_spec(rng)
        source = SourceText.of("s", text)
        bundle = compile_source(source)
        claims = [d for d in review_source(source).diagnostics if d.code in ("L605", "L606")]
        said += len(claims)
        if not claims:
            continue
        for _ in range(20):
            oracle = oracle_of(bundle, random_trace(rng))
            truth = {r.name: oracle.holds(r.root)[0] for r in bundle.requirements}
            for claim in claims:
                one, other = re.findall(r"r\d", claim.message)
                wrong = truth[one] and truth[other] if claim.code == "L605" else truth[other] and not truth[one]
                assert not wrong, f"{claim.message}\n{text}"
    assert said > 50


def test_a_param_without_a_value_silences_only_what_it_stands_in():
    text = "param T\nsoft late: eventually[0, T] q\nhard a: always (x > 5)\nhard b: always (x > 3)\n"
    assert codes(text) == ["L606"]
    assert codes("param T\nhard a: always[1, T] p\nhard b: always[1, inf] p\n") == []
    assert codes("param T\nparam S\nhard a: eventually[0, T] p\nhard b: eventually[0, S] p\n") == []
