"""The monitor as a whole: its promises, on random formulas and by hand."""

import copy
import json
import random
import sys

import numpy as np
import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.errors import DataError, UsageError
from stlspec.semantics.online import Monitor, Standing, late_warnings, make_monitor
from tests.semantics.online.cases import (
    PERIOD,
    STAMPS,
    STEP,
    bundle_of,
    check_rest,
    check_start,
    nested_formula,
    random_case,
    random_formula,
)
from tests.semantics.online.continuations import check_formulas, one_polarity
from tests.semantics.online.pairs import check_pairs

INF = float("inf")
SIGNALS = (Signal("x"), Signal("y"), Signal("b", "bool"))


def spec(build, signals=SIGNALS, base=STEP):
    """A spec whose requirements `build` returns by name."""
    builder = Builder()
    roots = build(builder)
    requirements = tuple(Requirement(name, "hard", root) for name, root in roots.items())
    return bundle_of(tuple(builder.nodes), requirements, signals, base)


def above(b, name, bound, op="gt"):
    return b.add(op, [b.add("signal", value=name), b.add("const", value=float(bound))])


def avoid(b):
    """always x >= 1."""
    return {"avoid": b.add("always", [above(b, "x", 1, "ge")], interval=(0, None))}


def respond(b, w=2):
    """always (x > 0 implies eventually[0, w] y > 0)."""
    late = b.add("eventually", [above(b, "y", 0)], interval=(0, w))
    body = b.add("or", [b.add("not", [above(b, "x", 0)]), late])
    return {"r": b.add("always", [body], interval=(0, None))}


def test_what_is_known_equals_the_naive_recursion_on_any_formula():
    rng = random.Random(1)
    for _ in range(500):
        check_start(random_case(rng))


def test_what_is_known_equals_the_naive_recursion_on_two_future_levels():
    rng = random.Random(2)
    for _ in range(500):
        check_start(random_case(rng, nested_formula, longest=16))


def test_offline_naive_and_online_values_are_one_on_pairs_of_all_operators():
    assert not check_pairs(2000, seed=8)


def test_known_pending_and_final_values_agree_with_naive_offline_and_oracle():
    rng = random.Random(3)
    for i in range(400):
        check_rest(random_case(rng, nested_formula if i % 3 == 0 else None, longest=8), rng)


def test_enclosures_hold_every_continuation_only_narrow_and_are_exact_hulls_where_promised():
    # 1 + 3 + 9 + 27 ends of each trace. `python -m tests.semantics.online.continuations` checks 5,000.
    assert check_formulas(500, seed=4) == 500 * 40


def test_a_promise_to_reach_the_horizon_changes_nothing_without_ranges():
    rng = random.Random(6)
    for _ in range(200):
        bundle = spec(lambda b: {"r": one_polarity(b, rng, rng.randint(1, 3))}, (Signal("x"), Signal("y")))
        monitors = [make_monitor(bundle, ends=ends) for ends in ("any", "horizon")]
        for _ in range(6):
            sample = {"x": rng.random() - 0.5, "y": rng.random() - 0.5}
            assert len({m.update(sample)["r"] for m in monitors}) == 1


def test_a_verdict_stays_once_it_is_told():
    rng = random.Random(7)
    for _ in range(200):
        case = random_case(rng, depth=2)
        monitor = case.monitor()
        told = [monitor.update(case.sample(i), case.stamp(i))["r"].verdict for i in range(case.n)]
        decided = [v for v in told if v != "undecided"]
        assert len(set(decided)) <= 1
        assert told[len(told) - len(decided) :] == decided


def test_always_and_eventually_by_hand():
    bundle = spec(
        lambda b: {
            **avoid(b),
            "late": b.add("eventually", [above(b, "y", 0)], interval=(2, 3)),
        },
        (Signal("x"), Signal("y", high=5.0)),
    )
    monitor = make_monitor(bundle)
    assert monitor.update({"x": 3, "y": 4})["avoid"] == Standing(-INF, 2.0, 2.0, "undecided")
    state = monitor.update({"x": 1, "y": 4})
    assert state["avoid"] == Standing(-INF, 0.0, 0.0, "undecided")
    assert state["late"] == Standing(-INF, 5.0, -INF, "undecided")
    assert monitor.update({"x": 1, "y": 2})["late"] == Standing(2.0, 5.0, 2.0, "satisfied")
    state = monitor.update({"x": 0, "y": -1})
    assert state["avoid"] == Standing(-INF, -1.0, -1.0, "violated")
    assert state["late"] == Standing(2.0, 2.0, 2.0, "satisfied")
    assert (monitor.n_samples, monitor.time) == (4, 3.0)


def test_a_tie_is_shown_as_zero_and_still_decides():
    monitor = make_monitor(spec(lambda b: {"r": b.add("eventually", [above(b, "x", 1, "ge")], interval=(0, None))}))
    assert monitor.update({"x": 1})["r"] == Standing(0.0, INF, 0.0, "satisfied")
    assert monitor.finish()["r"].robustness == 0.0


def test_every_gives_values_in_order_as_soon_as_the_horizon_has_come():
    bundle = spec(lambda b: {"r": b.add("always", [above(b, "x", 0)], interval=(0, 2))})
    monitor = make_monitor(bundle, "every")
    told = [[(k.sample, k.robustness) for k in monitor.update({"x": x})] for x in (3, 1, 2, -1, 5)]
    assert told == [[], [], [(0, 1.0)], [(1, -1.0)], [(2, -1.0)]]
    assert [(k.sample, k.robustness, k.verdict) for k in monitor.finish()] == [
        (3, -1.0, "violated"),
        (4, 5.0, "satisfied"),
    ]
    pending = monitor.pending()["r"]
    assert (pending.samples.tolist(), pending.times.tolist()) == ([3, 4], [3.0, 4.0])
    assert (pending.low.tolist(), pending.high.tolist()) == ([-INF, -INF], [-1.0, 5.0])
    with pytest.raises(ValueError, match="read-only"):
        pending.low[0] = 0


def test_every_is_as_early_as_the_windows_allow():
    rng = random.Random(8)
    checked = 0
    for _ in range(300):
        case = random_case(rng, lambda b, r, d, s: random_formula(b, r, d, s, past=False), depth=2)
        monitor = case.monitor("every")
        count = 0
        for n in range(1, case.n + 1):
            count += len(monitor.update(case.sample(n - 1), case.stamp(n - 1)))
            fixed = [_closed(case, case.root, t, n) for t in range(n)]
            if _closed(case, case.root, 0, 10**6):
                assert count == (fixed.index(False) if False in fixed else n), (case, n)
                checked += 1
            else:
                assert count == 0
    assert checked > 300


def _closed(case, index, t, n):
    """Whether no sample from number n on can be in a window of the node at t, nor in one below it."""
    node = case.nodes[index]
    if node.op == "next":
        return n > 10**5 or (t + 1 < n and _closed(case, node.children[0], t + 1, n))
    window = [t]
    if node.interval is not None:
        high = node.interval[1]
        if high is None:
            return False
        if n <= 10**5:
            high = high // (case.base.period or 1) * (case.base.period or 1)
            if case.times[t] + high > case.times[n - 1]:
                return False
            window = [j for j in range(t, n) if case.times[j] <= case.times[t] + high]
    return all(_closed(case, c, j, n) for c in node.children for j in window)


def test_values_without_end_come_at_the_end_and_are_warned_of():
    bundle = spec(avoid)
    (warning,) = late_warnings(bundle)
    assert (warning.code, "'avoid'" in warning.message) == ("D894", True)
    assert late_warnings(spec(lambda b: {"r": above(b, "x", 0)})) == ()
    monitor = make_monitor(bundle, "every")
    assert [monitor.update({"x": x}) for x in (3, 1, 2)] == [[], [], []]
    assert [k.robustness for k in monitor.finish()] == [0.0, 0.0, 1.0]


def test_pending_at_the_start_is_sample_0_until_it_is_a_number():
    monitor = make_monitor(spec(lambda b: {"r": b.add("always", [above(b, "x", 0)], interval=(0, 1))}))
    assert len(monitor.pending()["r"].samples) == 0
    monitor.update({"x": 2})
    pending = monitor.pending()["r"]
    assert (pending.samples.tolist(), pending.low.tolist(), pending.high.tolist()) == ([0], [-INF], [2.0])
    monitor.update({"x": 3})
    assert len(monitor.pending()["r"].samples) == 0


BAD_SAMPLES = [
    ({"x": float("nan"), "y": 0.0}, None, "D801", "signal 'x' is NaN at sample 2"),
    ({"x": 0.0, "y": 4.0}, None, "D807", "outside its range"),
    ({"x": 0.0, "y": float("nan")}, None, "D801", "'y' is NaN"),
    ({"x": 0.0}, None, "D804", "'y'"),
    ({"x": "fast", "y": 0.0}, None, "D806", "'fast'"),
    ({"x": None, "y": 0.0}, None, "D806", "None"),
    ({"x": 10**400, "y": 0.0}, None, "D806", "not a real value"),
    ([0.0, 1.0], None, "D813", "not a mapping"),
    ({"x": INF, "y": 0.0}, None, "D808", r"x - x is not a number at sample 2: x = inf"),
]


@pytest.mark.parametrize(("sample", "time", "code", "message"), BAD_SAMPLES)
@pytest.mark.parametrize("reading", ["start", "every"])
def test_a_refused_sample_leaves_the_monitor_as_it_was(sample, time, code, message, reading):
    def build(b):
        x = b.add("signal", value="x")
        zero = b.add("le", [b.add("sub", [x, x]), b.add("delta", [x])])
        return {"r": b.add("always", [b.add("or", [zero, above(b, "y", 0)])], interval=(0, 4))}

    bundle = spec(build, (Signal("x"), Signal("y", low=-1.0, high=3.0)))
    monitor, twin = make_monitor(bundle, reading), make_monitor(bundle, reading)
    for good in ({"x": 1, "y": 1}, {"x": 2, "y": 0}):
        assert monitor.update(good) == twin.update(good)
    before = monitor.to_bytes()
    with pytest.raises(DataError, match=message) as caught:
        monitor.update(sample, time)
    assert [d.code for d in caught.value.diagnostics] == [code]
    assert monitor.to_bytes() == before
    for good in ({"x": 3, "y": 2}, {"x": 0, "y": 3}, {"x": 0, "y": 3}):
        assert monitor.update(good) == twin.update(good)


@pytest.mark.parametrize(
    ("base", "times", "code"),
    [
        (STAMPS, [0.0, 1.0, 1.0], "D802"),
        (STAMPS, [0.0, None], "D810"),
        (STAMPS, [0.0, INF], "D812"),
        (STAMPS, [0.0, "now"], "D806"),
        (STEP, [0.0, 1.0, 0.5], "D802"),
        (STEP, [0.0, None], "D891"),
        (PERIOD, [None, 2.0], "D891"),
        (PERIOD, [0.0, 3.0], "D811"),
        (PERIOD, [0.0, 2.0, 2.01], "D811"),
    ],
)
def test_a_bad_time_stamp_leaves_the_monitor_as_it_was(base, times, code):
    monitor = make_monitor(spec(avoid, base=base))
    for time in times[:-1]:
        monitor.update({"x": 1.0}, time)
    before = monitor.to_bytes()
    with pytest.raises(DataError, match=code):
        monitor.update({"x": 1.0}, times[-1])
    assert monitor.to_bytes() == before
    monitor.update({"x": 1.0}, None if times[0] is None else 4.0)


def test_a_gap_breaks_the_promise_to_reach_the_horizon():
    bundle = spec(avoid, base=PERIOD)
    loose, strict = make_monitor(bundle), make_monitor(bundle, ends="horizon")
    for monitor in (loose, strict):
        monitor.update({"x": 1.0}, 0.0)
    loose.update({"x": 1.0}, 4.0)
    with pytest.raises(DataError, match="D892"):
        strict.update({"x": 1.0}, 4.0)


def test_stamps_close_to_the_period_are_taken_as_such():
    monitor = make_monitor(spec(avoid, base=PERIOD), "every")
    bundle = spec(lambda b: {"r": b.add("always", [above(b, "x", 0)], interval=(0, 20))}, base=PERIOD)
    monitor = make_monitor(bundle, "every")
    assert monitor.update({"x": 1.0}, 100.0) == []
    (known,) = monitor.update({"x": 2.0}, 102.01)
    assert (known.time, known.robustness) == (100.0, 1.0)
    assert monitor.time == 102.01


def test_every_refuses_what_would_need_a_deep_stack():
    def deep(b):
        p = above(b, "x", 0)
        for _ in range(200):
            p = b.add("next", [p])
        return {"r": p}

    with pytest.raises(UsageError, match="150 deep"):
        make_monitor(spec(deep, base=PERIOD), "every")
    assert make_monitor(spec(deep)).update({"x": 1})["r"].verdict == "undecided"
    counted = make_monitor(spec(deep), "every")
    assert [len(counted.update({"x": 1})) for _ in range(202)] == [0] * 200 + [1, 1]


def test_without_samples_nothing_is_finished():
    with pytest.raises(DataError, match="D803"):
        make_monitor(spec(avoid)).finish()


def test_unknown_words_are_refused():
    with pytest.raises(UsageError, match="reading='all'"):
        make_monitor(spec(avoid), "all")
    with pytest.raises(UsageError, match="ends='never'"):
        make_monitor(spec(avoid), ends="never")


def test_a_saved_monitor_goes_on_as_if_nothing_had_happened():
    bundle = spec(lambda b: {**avoid(b), **respond(b), "past": b.add("once", [above(b, "y", 0)], interval=(1, 3))})
    rng = random.Random(9)
    for reading in ("start", "every"):
        monitor = make_monitor(bundle, reading)
        for _ in range(30):
            sample = {"x": rng.choice([-1.0, 0.5, INF]), "y": rng.random() - 0.7}
            saved = monitor.to_bytes()
            json.loads(saved.decode(), parse_constant=lambda _: pytest.fail("no JSON number"))
            restored = Monitor.from_bytes(bundle, saved)
            assert restored.to_bytes() == saved
            assert restored.update(sample) == monitor.update(sample)
            monitor = restored


def test_a_monitor_of_another_spec_is_not_restored():
    saved = make_monitor(spec(avoid)).to_bytes()
    with pytest.raises(DataError, match="another spec"):
        Monitor.from_bytes(spec(respond), saved)


def test_hostile_bytes_are_refused_or_harmless():
    bundle = spec(lambda b: {**respond(b), "u": b.add("until", [above(b, "x", 0), above(b, "y", 0)], interval=(1, 4))})
    rng = random.Random(10)
    for junk in (b"", b"\xff", b"[]", b"{}", b"[" * 100_000, b'{"schema":"stlspec.monitor/1"}'):
        with pytest.raises(DataError, match="D893"):
            Monitor.from_bytes(bundle, junk)
    refused = 0
    for reading in ("start", "every"):
        monitor = make_monitor(bundle, reading)
        for _ in range(9):
            monitor.update({"x": rng.random(), "y": rng.random() - 0.5})
        document = json.loads(monitor.to_bytes())
        for _ in range(300):
            damaged = _damaged(json.loads(json.dumps(document)), rng)
            try:
                restored = Monitor.from_bytes(bundle, json.dumps(damaged).encode())
            except DataError as error:
                assert error.diagnostics[0].code == "D893"
                refused += 1
                continue
            for _ in range(8):
                restored.update({"x": 0.0, "y": -1.0})
    assert refused > 200


def _damaged(value, rng):
    """Change one place of a JSON value at random."""
    if isinstance(value, dict) and value and rng.random() < 0.95:
        key = rng.choice(list(value))
        return value | {key: _damaged(value[key], rng)}
    if isinstance(value, list) and value and rng.random() < 0.9:
        at = rng.randrange(len(value))
        return [*value[:at], _damaged(value[at], rng), *value[at + 1 :]]
    return rng.choice([None, "inf", -3, 10**30, 0.5, [], [1], {}, "x", True])


W_SWEEP = {
    "always": lambda b, w: b.add("always", [above(b, "x", 0)], interval=(0, w)),
    "until": lambda b, w: b.add("until", [above(b, "x", 0), above(b, "y", 0)], interval=(0, w)),
    "response": lambda b, w: respond(b, w)["r"],
    "stable": lambda b, w: b.add(
        "eventually", [b.add("always", [above(b, "x", 0)], interval=(w // 2, w))], interval=(0, None)
    ),
    "nested until": lambda b, w: b.add(
        "always",
        [b.add("until", [above(b, "x", 0), above(b, "y", 0)], interval=(w // 2, w))],
        interval=(0, None),
    ),
    "two unknowns": lambda b, w: b.add(
        "always",
        [
            b.add(
                "or",
                [
                    b.add("eventually", [above(b, "y", 0)], interval=(0, w)),
                    b.add("always", [above(b, "x", 0)], interval=(0, w // 2)),
                ],
            )
        ],
        interval=(0, None),
    ),
}


def inputs(kind, n):
    """Samples that are random, rising, falling or a sawtooth."""
    rng = random.Random(11)
    wave = {
        "random": lambda i: rng.random() - 0.5,
        "rising": lambda i: i / n - 0.5,
        "falling": lambda i: 0.5 - i / n,
        "sawtooth": lambda i: (i % 97) / 97 - 0.5,
    }[kind]
    return [{"x": wave(i), "y": -wave(i)} for i in range(n)]


def lines_executed(bundle, reading, samples, warm):
    """How many lines of Python the monitor runs for the samples after the first `warm`."""
    monitor = make_monitor(bundle, reading)
    for sample in samples[:warm]:
        monitor.update(sample)
    count = 0

    def trace(frame, event, argument):
        nonlocal count
        count += event == "line"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        for sample in samples[warm:]:
            monitor.update(sample)
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize("kind", ["random", "rising", "falling", "sawtooth"])
@pytest.mark.parametrize("name", W_SWEEP)
def test_the_work_for_a_sample_does_not_depend_on_the_window(name, kind):
    readings = ["start"] if name not in ("always", "until") else ["start", "every"]
    for reading in readings:
        counts = []
        for w in (10, 400):
            bundle = spec(lambda b, w=w: {"r": W_SWEEP[name](b, w)})
            counts.append(lines_executed(bundle, reading, inputs(kind, 1600), 800))
        # The lines of list and generator expressions count too, so a few lines a sample is the noise.
        assert counts[1] <= 1.3 * counts[0] + 800


def test_a_million_equal_samples_do_not_grow_the_memory():
    def build(b):
        return {**avoid(b), "u": b.add("until", [above(b, "x", 0), above(b, "y", 0)], interval=(0, None))}

    monitor = make_monitor(spec(build))
    sizes = []
    for count in (10, 999_990):
        for _ in range(count):
            monitor.update({"x": 1.0, "y": -1.0})
        sizes.append(len(monitor.to_bytes()))
    assert sizes[1] < sizes[0] + 100


@pytest.mark.parametrize("reading", ["start", "every"])
@pytest.mark.parametrize("value", [1.0, -1.0])
def test_memory_is_bounded_by_the_horizon(reading, value):
    def build(b):
        inner = b.add("always", [above(b, "x", 0)], interval=(0, 7))
        deep = b.add("eventually", [b.add("and", [inner, above(b, "y", 0)])], interval=(0, 5))
        outer = (0, 9) if reading == "every" else (0, None)
        return {"r": b.add("always", [deep], interval=outer), "s": b.add("always", [inner], interval=outer)}

    monitor = make_monitor(spec(build), reading)
    sizes = []
    for count in (2000, 4000):
        for i in range(count):
            monitor.update({"x": value * (i % 3), "y": value})
        sizes.append(len(monitor.to_bytes()))
    assert sizes[1] < 1.5 * sizes[0] + 2000


def test_infinite_samples_are_values():
    bundle = spec(avoid)
    monitor = make_monitor(bundle)
    assert monitor.update({"x": np.float32("inf")})["avoid"].high == INF
    assert monitor.update({"x": -INF})["avoid"] == Standing(-INF, -INF, -INF, "violated")


@pytest.mark.parametrize("copied", [Monitor.copy, copy.copy, copy.deepcopy, lambda m: copy.deepcopy([m])[0]])
@pytest.mark.parametrize("reading", ["start", "every"])
def test_a_copy_goes_its_own_way_however_it_is_made(copied, reading):
    monitor = make_monitor(spec(avoid), reading)
    monitor.update({"x": 3.0})
    other = copied(monitor)
    before = monitor.to_bytes()
    assert other.to_bytes() == before
    other.update({"x": -1.0})
    assert monitor.to_bytes() == before
    assert other.n_samples == 2
