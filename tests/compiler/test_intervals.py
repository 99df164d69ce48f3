"""Bounds of windows: units, order, rounding to ticks."""

import pytest

from stlspec.compiler.checks import check
from stlspec.lang.parse import parse
from stlspec.source import SourceText


def window(interval, time):
    text = f"time {time}\nsignal x\nparam T = 2\nparam U = 1.5 s\nhard a: always{interval} (x > 1)"
    model, problems = check(parse(SourceText.of("s", text)))
    return [d.code for d in problems], next(iter(model.intervals.values()), None)


@pytest.mark.parametrize(
    ("interval", "time", "expected"),
    [
        ("[0, 5]", "step", (0, 5)),
        ("[T, 2 * T]", "step", (2, 4)),
        ("[3, 3]", "step", (3, 3)),
        ("[0, inf]", "step", (0, None)),
        ("[0, 5 step]", "step", (0, 5)),
        ("[0, 0.1 * 30]", "step", (0, 3)),
        ("[0.1 * 30, 9]", "step", (3, 9)),
        ("[0, 5 s]", "s", (0, 5 * 10**9)),
        ("[200 ms, U]", "s", (2 * 10**8, 15 * 10**8)),
        ("[0, inf]", "s", (0, None)),
        ("[0, 0.3 s]", "100 ms", (0, 3 * 10**8)),
        ("[1 ns, 1 h]", "us", (1, 3600 * 10**9)),
        ("[0.4 ns, 1.6 ns]", "ns", (0, 2)),
        ("[0, 2 * U + 100 ms]", "s", (0, 31 * 10**8)),
    ],
)
def test_bounds_become_whole_ticks(interval, time, expected):
    assert window(interval, time) == ([], expected)


@pytest.mark.parametrize(
    ("interval", "time", "expected"),
    [
        ("[0, 2.5]", "step", (0, 2)),
        ("[0.5, 2.5]", "step", (1, 2)),
        ("[0, 250 ms]", "100 ms", (0, 25 * 10**7)),
        ("[50 ms, inf]", "100 ms", (5 * 10**7, None)),
    ],
)
def test_a_bound_between_two_samples_is_a_warning(interval, time, expected):
    assert window(interval, time) == (["I403"], expected)


@pytest.mark.parametrize(
    ("interval", "time", "code"),
    [
        ("[5, 2]", "step", "I401"),
        ("[inf, 5]", "step", "I404"),
        ("[1 s, 300 ms]", "s", "I401"),
        ("[-1, 5]", "step", "I402"),
        ("[0, -inf]", "step", "I402"),
        ("[0.2, 0.8]", "step", "I404"),
        ("[110 ms, 190 ms]", "100 ms", "I404"),
        ("[0, 1e19]", "step", "I405"),
        ("[0, 5]", "s", "U303"),
        ("[0, T]", "s", "U303"),
        ("[0, 5 s]", "step", "U304"),
        ("[0, 5 step]", "s", "U304"),
        ("[0, 5 m]", "s", "U304"),
        ("[0, 5 s / 1 s]", "s", "U304"),
        ("[0, 1 s * 1 s]", "s", "U304"),
    ],
)
def test_a_wrong_interval_is_one_error_and_has_no_window(interval, time, code):
    assert window(interval, time) == ([code], None)


@pytest.mark.parametrize(
    ("interval", "time", "help_"),
    [
        ("[5, 2]", "step", "write [2, 5]"),
        ("[0, 5]", "s", "write `5 s`"),
        ("[0, 500]", "100 ms", "write `500 ms`"),
        ("[0, 5]", "100 ms", "write `5 s`; 5 samples are `500 ms`"),
        ("[0.5, 2.5]", "100 ms", "write `[0.5 s, 2.5 s]`"),
        ("[1, 2 + 3]", "30 s", "write `[1 min, 2 min + 3 min]`"),
        ("[0, 0.3]", "7 h", "write `0.3 h`"),
        ("[0, 1e305]", "7 ms", "write `1e305 ms`"),
        ("[1, 5 s]", "ms", "write `1 s`"),
        ("[5, 2]", "s", "write `[2 s, 5 s]`"),
        ("[5, 2 s]", "ms", "write `[2 s, 5 s]`"),
        ("[5,  2 - 1]", "100 ms", "write `[2 s - 1 s,  5 s]`"),
        ("[5, 0]", "s", "write `[0, 5 s]`"),
        (
            "[0, 5 ms]",
            "50 ms",
            "the period is 50 ms: a window of more than one sample reaches further, as in [0, 50 ms]",
        ),
        (
            "[90 ms, 110 ms]",
            "0.1 s",
            "the period is 0.1 s: a window of more than one sample reaches further, as in [0.1 s, 0.2 s]",
        ),
        (
            "[0, 0.5]",
            "step",
            "bounds count whole samples: a window of more than one sample reaches further, as in [0, 1]",
        ),
        ("[0, 1]", "0.1 s", "write `1 s`; 1 sample is `0.1 s`"),
        ("[0, 250 ms]", "100 ms", "write [0, 200 ms] to say so"),
        ("[0, 5 s]", "step", "write a number of samples or declare `time s`"),
    ],
)
def test_the_way_out_can_be_written_as_it_stands(interval, time, help_):
    text = f"time {time}\nsignal x\nhard a: always{interval} (x > 1)"
    (problem,) = check(parse(SourceText.of("s", text)))[1]
    assert problem.help == help_


@pytest.mark.parametrize(
    "interval", ["[5, 2]", "[0, 5]", "[5, 2 s]", "[1, 5 s]", "[3 - 1, 1]", "[0.5, 0]", "[(5), (2)]"]
)
@pytest.mark.parametrize("time", ["s", "ms", "100 ms", "500 ms"])
def test_what_a_bound_without_a_unit_is_told_leaves_nothing_to_report(interval, time):
    text = f"time {time}\nsignal x\nhard a: always{interval} (x > 1)"
    (problem,) = check(parse(SourceText.of("s", text)))[1]
    assert problem.code == "U303"
    assert check(parse(SourceText.of("s", problem.fixes[0].applied(text))))[1] == ()
