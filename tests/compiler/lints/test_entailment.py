"""The rules behind contradictions and containment, on the DAG."""

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.lints.entailment import Entailment
from stlspec.compiler.ranges import value_ranges
from stlspec.source import SourceText


def rules_of(*formulas, head="signal x in [0, 10]\nsignal p: bool\n"):
    text = head + "".join(f"hard r{i}: {formula}\n" for i, formula in enumerate(formulas))
    bundle = compile_source(SourceText.of("s", text))
    rules = Entailment(bundle.nodes, value_ranges(bundle.nodes, bundle.signals, bundle.time))
    return rules, [r.root for r in bundle.requirements]


def test_a_tighter_bound_entails_a_wider_one_and_not_the_other_way():
    rules, (tight, wide) = rules_of("x > 5", "x >= 5")
    assert rules.entails(tight, wide) and not rules.entails(wide, tight)


def test_bounds_that_meet_at_a_point_exclude_each_other_only_if_one_is_open():
    rules, (over, under, at) = rules_of("x > 5", "x <= 5", "x >= 5")
    assert rules.excludes(over, under) and not rules.excludes(at, under)


def test_the_declared_range_counts():
    rules, (high, anything) = rules_of("x > 10", "x > 1")
    assert rules.excludes(high, anything)


def test_a_negated_bound_is_the_opposite_bound():
    rules, (low, high) = rules_of("not (x > 5)", "x > 6")
    assert rules.excludes(low, high)


def test_a_deep_pair_ends_without_an_answer():
    deep = "next " * 180
    rules, (one, other) = rules_of(f"{deep}(p)", f"{deep}(x > 1)")
    assert not rules.entails(one, other)
