"""The checks of a whole spec: order of diagnostics, one for each root cause, the graph, ranges, lets in any order."""

import pytest

from stlspec.compiler.checks import check, names_in
from stlspec.compiler.model import Binding
from stlspec.lang.parse import parse, parse_formula
from stlspec.source import SourceText

CHAIN = "hard r0: true\n" + "".join(f"soft r{i} depends on r{i - 1}: true\n" for i in range(1, 6))


def checked(text, **bindings):
    return check(parse(SourceText.of("s", text)), bindings)


def codes(text):
    return [d.code for d in checked(text)[1]]


def test_a_good_spec_gives_a_complete_model():
    model, problems = checked(
        'time s\nsignal v unit "m/s" in [0, top] from "obs.v" "speed"\nparam T = 2 min\nlet top = 2 * 15 m/s\n'
        "let slow = v < top / 2\nhard a: always[0, T] slow\nsoft b depends on a: eventually slow"
    )
    assert problems == ()
    signal = model.signals["v"]
    assert (signal.low, signal.high, signal.unit, signal.source, signal.doc) == (0, 30, "m/s", "obs.v", "speed")
    assert (model.params["T"].value, model.params["T"].unit) == (2, "min")
    assert set(model.let_order) == {"top", "slow"}
    assert list(model.intervals.values()) == [(0, 120 * 10**9)]


def test_diagnostics_come_in_the_order_of_the_text_and_each_once():
    text = "hard a: y > 1\nsignal x\nhard b: x\nsignal x\nhrad c: x\n"
    assert codes(text) == ["N101", "T201", "N102", "S003"]


@pytest.mark.parametrize(
    "text",
    [
        "signal x : (\nhard a: x > 1 and x < 3",
        "let p = x >\nhard a: p and always p",
        "param T = 5 sec\nsignal x\nhard a: always[0, T] x > T",
        "let p = q\nlet q = p\nhard a: p",
        "hard a: x\nsignal x 5\nsoft b depends on a: true",
        "hrad a: true\nhard b depends on a: true",
        "signal x\nlet p = x + y > 1\nhard a: p and p\nhard b: p",
        'signal x unit "m//s"\nhard a: x > 3 kg',
        "signal x\nlet f(y) = x > y\nhard a: f(3) and f(4, 5)",
    ],
)
def test_one_root_cause_is_one_diagnostic(text):
    assert len(codes(text)) == 1


def test_lets_may_be_used_before_they_are_declared():
    assert codes("signal x\nhard a: p\nlet p = q and x > r\nlet q = x < s\nlet r = 2 * s\nlet s = 3") == []


def test_a_let_may_be_a_real_expression_with_a_unit():
    assert codes('signal v unit "m/s"\nlet e = abs(v - 3)\nhard a: e < 1 m/s') == []
    assert codes('signal v unit "m/s"\nlet e = abs(v - 3)\nhard a: e < 1 s') == ["U301"]
    assert codes("signal v\nlet e = abs(v - 3)\nhard a: e") == ["T201"]


def test_an_argument_hides_a_let_of_the_same_name():
    assert codes("signal x\nlet p(q) = q > 1\nlet q = x > 1 and p(x)\nhard a: x > 1") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("hard a: true\nsoft b depends on a: true\nsoft c depends on b: true", []),
        ("soft a: true\nsoft b: true", []),
        ("hard a: true\nsoft b: true", ["G505"]),
        ("hard a: true\nsoft b: true\nsoft c depends on b: true", ["G505"]),
        ("hard a: true\nsoft b depends on b: true", ["G503"]),
        ("hard a depends on b, c: true\nhard b: true", ["G502"]),
        ("hard a depends on b: true\nhard b depends on a: true", ["G501"]),
        ("soft a: true\nhard b depends on a: true", ["G504"]),
        ("hard a: true\nsoft b depends on a: true\nsoft c depends on b: true\nsoft d depends on c: true", []),
        (CHAIN, ["G507"]),
    ],
)  # fmt: skip
def test_the_graph_of_requirements_is_checked(text, expected):
    assert codes(text) == expected


@pytest.mark.parametrize(
    ("text", "help_"),
    [
        ("soft b depends on nowhere: true", "remove `depends on nowhere`, or state `hard nowhere: ...`"),
        ("hard a: true\nhard b depends on nowhere: true", "remove `depends on nowhere`, or state `hard nowhere: ...`"),
        ("hard a: true\nsoft b depends on nowhere: true", "write `depends on a`, or state `hard nowhere: ...`"),
        ("hard a: true\nsoft b depends on a, no: true", "remove `no` and its comma, or state `hard no: ...`"),
        ("signal x\nhard a: x > 1\nsoft b depends on x: true", "write `depends on a`"),
        ("signal x\nhard b depends on x: x > 1", "remove `depends on x`"),
    ],
)  # fmt: skip
def test_the_way_out_of_a_dependency_on_nothing_leaves_nothing_to_report(text, help_):
    (problem,) = checked(text)[1]
    assert (problem.code, problem.help) == ("G502", help_)
    assert codes(problem.fixes[0].applied(text)) == []


def test_a_hidden_problem_of_a_broken_spec_keeps_its_warnings_silent():
    assert codes("hard a: x >\nsignal x\nsoft b: x > 1") == ["S002"]


@pytest.mark.parametrize(
    ("limits", "expected"),
    [("[0, 5]", (0, 5)), ("[-inf, 5 m/s]", (-float("inf"), 5)), ("[0, k * 2]", (0, 6)), ("[-k, top]", (-3, 4))],
)
def test_a_range_may_use_params_lets_and_the_unit_of_the_signal(limits, expected):
    model, problems = checked(f'signal v unit "m/s" in {limits}\nparam k = 3\nlet top = k + 1\nhard a: v > 0')
    assert problems == ()
    assert (model.signals["v"].low, model.signals["v"].high) == expected


@pytest.mark.parametrize(
    ("limits", "code"),
    [("[0 m, 5]", "U301"), ("[0, 5 s]", "U301"), ("[0, v]", "T204"), ("[3, 3]", "T206"), ("[5, 1]", "T206")],
)
def test_a_range_of_another_unit_or_order_is_refused(limits, code):
    assert codes(f'signal v unit "m/s" in {limits}\nhard a: v > 0') == [code]


def test_values_from_outside_replace_those_of_the_text_and_are_judged_like_them():
    text = "time s\nsignal x\nparam T = 5 s\nparam L = 2 s\nhard a: always[L, T] x > 1"
    assert checked(text)[1] == ()
    assert [d.code for d in checked(text, T=Binding(1.0))[1]] == ["I401"]
    model, problems = checked("time s\nsignal x\nparam T\nhard a: always[0, T] x > 1", T=Binding(200.0, "ms"))
    assert problems == ()
    assert list(model.intervals.values()) == [(0, 200_000_000)]


def test_params_without_a_value_are_accepted_and_their_windows_stay_open():
    model, problems = checked("signal x\nparam T\nhard a: always[0, T + 1] x > T")
    assert (problems, model.params, model.intervals) == ((), {}, {})


def test_names_are_found_in_bounds_but_an_index_is_none():
    node, _ = parse_formula(SourceText.of("f", "always[a, b + c] x[t] > min(d, 2)"))
    assert sorted(names_in(node)) == ["a", "b", "c", "d", "min", "x"]
