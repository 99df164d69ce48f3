"""The fixed schedule for counted samples: operators against their definitions over many blocks, and saved blocks."""

import random

import pytest

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.evaluation import evaluate
from stlspec.semantics.online import Monitor, make_monitor
from stlspec.semantics.online.flow import Block, Delay, UntilBlock
from stlspec.semantics.online.saving import Unsound
from tests.semantics.online.cases import bundle_of, random_formula

SIGNALS = (Signal("x"), Signal("y"), Signal("b", "bool"))
INTERVALS = [(0, 0), (0, 1), (3, 3), (0, 6), (2, 3), (2, 9), (7, 8), (1, 13), (0, 60), (70, 80)]


def bundle(build):
    b = Builder()
    root = build(b)
    return bundle_of(tuple(b.nodes), (Requirement("r", "hard", root),), SIGNALS)


def known(spec, data, copies=None):
    """What the reading `every` tells of a trace, sample by sample; copied now and then if `copies` draws so."""
    monitor, n, told = make_monitor(spec, "every"), len(data["x"]), []
    for i in range(n):
        if copies is not None and copies.random() < 0.1:
            monitor = monitor.copy() if copies.random() < 0.5 else Monitor.from_bytes(spec, monitor.to_bytes())
        told.append(monitor.update({name: values[i] for name, values in data.items()}))
    return told, monitor.finish()


def random_data(rng, n):
    return {
        "x": [rng.choice([-2.0, 0.0, 0.5, 3.0, rng.uniform(-2, 3)]) for _ in range(n)],
        "y": [rng.choice([-2.0, 1.0, rng.uniform(-2, 3)]) for _ in range(n)],
        "b": [rng.random() < 0.5 for _ in range(n)],
    }


def positive(b, name):
    return b.add("gt", [b.add("signal", value=name), b.add("const", value=0.0)])


@pytest.mark.parametrize("interval", INTERVALS)
@pytest.mark.parametrize("op", ["always", "eventually", "until"])
def test_a_window_is_told_just_when_it_has_passed_as_the_definition_has_it(op, interval):
    rng = random.Random(f"{op} {interval}")
    data = random_data(rng, 60 if interval[1] < 50 else 300)
    spec = bundle(lambda b: b.add(op, [positive(b, x) for x in "xy"[: 2 if op == "until" else 1]], interval=interval))
    low, high = interval
    told, _ = known(spec, data)
    x, y = data["x"], data["y"]
    for n, found in enumerate(told):
        t = n - high
        if t < 0:
            assert found == []
            continue
        window = range(t + low, n + 1)
        expected = {
            "always": lambda window: min(x[j] for j in window),
            "eventually": lambda window: max(x[j] for j in window),
            "until": lambda window, t=t: max(min([y[j], *x[t:j]]) for j in window),
        }[op](window)
        assert [(k.sample, k.time, k.robustness, k.verdict == "satisfied") for k in found] == [
            (t, float(t), expected, expected > 0)
        ]


def test_any_nesting_over_many_blocks_has_the_bits_of_the_offline_engine():
    rng = random.Random(2)
    for i in range(300):
        spec = bundle(lambda b: random_formula(b, rng, rng.randint(1, 4)))
        data = random_data(rng, 40)
        told, rest = known(spec, data, rng if i % 3 == 0 else None)
        found = [k for some in told for k in some] + rest
        offline = evaluate(spec, data)["r"]
        assert [k.sample for k in found] == list(range(40))
        assert [k.robustness.hex() for k in found] == [v.hex() for v in offline.signal.tolist()]
        assert [k.verdict == "satisfied" for k in found] == (offline.values > 0).tolist()


def test_a_value_that_is_passed_on_is_not_mistaken_for_a_later_one():
    """not always[3, 3] p and not p: the same variable at two levels."""

    def build(b):
        p = positive(b, "x")
        late = b.add("not", [b.add("always", [p], interval=(3, 3))])
        return b.add("or", [late, b.add("and", [b.add("not", [p]), b.add("next", [b.add("not", [late])])])])

    data = random_data(random.Random(3), 30)
    spec = bundle(build)
    told, rest = known(spec, data)
    assert [k.robustness for some in [*told, rest] for k in some] == evaluate(spec, data)["r"].signal.tolist()


@pytest.mark.parametrize(
    "make", [lambda: Block(2, 4, True, True), lambda: UntilBlock(2, 4, (True, True)), lambda: Delay(2, 4)]
)
@pytest.mark.parametrize("n", [0, 2, 3, 5, 6, 8, 11])
def test_a_saved_block_of_another_length_is_refused(make, n):
    part = make()
    pushed = max(0, n - 2)
    blocks, new = divmod(pushed, 4)
    sizes = {"values": min(pushed, 4), "newer": new, "lefts": new, "rights": new}
    state = part.save()
    for name in part.STATE:
        state[name] = [0.0] * sizes.get(name, 3 - new if blocks else 0)
    part.load(state)
    part.check(n, n - 1)
    for name in part.STATE:
        part.load(state | {name: [*state[name], 1.0]})
        with pytest.raises(Unsound):
            part.check(n, n - 1)
