"""The machine of hard requirements, against the evaluator on every prefix of random traces."""

import random

import pytest

from stlspec import api
from stlspec.learning.memory import FutureInPastError, at_end, first_state, make_machine, read, samples_of

HEAD = "signal p: bool\nsignal q: bool\n"
FORMULAS = [
    "always p", "always[0, 3] p", "always[2, 4] p", "eventually[1, 3] p", "eventually p", "p until q",
    "p until[1, 3] q", "p until[2, inf] q", "always (p implies eventually[0, 2] q)", "always (p implies next q)",
    "not (p until[0, 2] q)", "always[0, 5] eventually[0, 2] p", "p", "wnext (p or q)", "next next p",
    "always (once[0, 2] p)", "always (once[1, 3] p or q)", "always (historically[0, 2] p or q)",
    "always (q implies historically[1, 2] p)", "always (p since q)", "always (p since[0, 2] q or p)",
    "always (p since[1, 3] q or p)", "always (p since[2, inf] q or not q)", "always (prev p implies q)",
    "always (wprev p or q)", "always (once[2, inf] p implies q)", "always (historically[1, inf] p or q)",
    "always (prev once[0, 1] (p and not q) implies eventually[0, 2] q)", "p unless q", "p release q",
    "always (p iff next q)", "always (not eventually[0, 2] (p and q))", "eventually[0, 3] always[0, 2] p",
    "always (p implies (not q until[0, 3] p))", "(always[0, 2] p) or (eventually[1, 2] q)",
]  # fmt: skip


def machine_of(formula, head=HEAD):
    bundle = api.compile(f"{head}hard a: {formula}")
    root = bundle.requirements[0].root
    return bundle, make_machine(bundle.nodes, [root], bundle.time)


def letters(machine, values):
    """Evaluate the letters of a machine, which over p and q are Boolean combinations."""
    found = {}
    for index, node in enumerate(machine.nodes):
        inner = [found.get(c) for c in node.children]
        if node.op == "bool":
            found[index] = values[node.value]
        elif node.op in ("true", "false"):
            found[index] = node.op == "true"
        elif None not in inner and node.op in ("not", "and", "or"):
            found[index] = not inner[0] if node.op == "not" else (all if node.op == "and" else any)(inner)
    return [found[index] for index in machine.letters]


@pytest.mark.parametrize("formula", FORMULAS)
def test_it_agrees_with_the_evaluator_at_every_end(formula):
    """At each prefix: what is left decides the verdict if the trace ends there, and False is final."""
    bundle, machine = machine_of(formula)
    draw = random.Random(formula)
    for _ in range(12):
        share = draw.random()
        trace = [{"p": draw.random() < share, "q": draw.random() < 0.5} for _ in range(10)]
        state, lost = first_state(machine), False
        for end in range(1, len(trace) + 1):
            state = read(machine, state, letters(machine, trace[end - 1]))
            columns = {name: [sample[name] for sample in trace[:end]] for name in ("p", "q")}
            holds = bundle.evaluate(columns)["a"].verdict.value == "satisfied"
            assert at_end(machine, state[0][0]) == holds, (trace[:end], state)
            lost = lost or state[0][0] is False
            assert not (lost and holds)


@pytest.mark.parametrize(
    ("formula", "most"),
    [
        ("always p", 2),
        ("always (prev once[0, 50] p implies q)", 55),
        ("always (p implies eventually[0, 50] q)", 54),
        ("always (p implies not eventually[0, 50] q)", 54),
        ("always[0, 30] p", 33),
        ("not q until p", 4),
        ("always (once[20, inf] p or q)", 25),
    ],
)
def test_timers_saturate_so_that_states_are_few(formula, most):
    _, machine = machine_of(formula)
    found, stack = set(), [first_state(machine)]
    while stack:
        state = stack.pop()
        if state not in found and state[0][0] is not False:
            found.add(state)
            for p in (False, True):
                stack += [read(machine, state, letters(machine, {"p": p, "q": q})) for q in (False, True)]
    assert len(found) <= most


def test_a_violation_is_known_at_the_first_sample_that_makes_it_certain():
    _, machine = machine_of("always (p implies eventually[0, 2] q)")
    state = first_state(machine)
    verdicts = []
    for p, q in [(True, False), (False, False), (False, False), (False, True)]:
        state = read(machine, state, letters(machine, {"p": p, "q": q}))
        verdicts.append(state[0][0] is False)
    assert verdicts == [False, False, True, True]


def test_the_past_of_the_future_is_refused():
    with pytest.raises(FutureInPastError):
        machine_of("always (once (eventually[0, 2] p))")


def test_bounds_become_the_samples_inside_them():
    bundle = api.compile("time 100 ms\nsignal p: bool\nhard a: always[150 ms, 420 ms] p")
    assert samples_of(bundle.nodes[bundle.requirements[0].root].interval, bundle.time) == (2, 4)
    assert samples_of((0, None), bundle.time) == (0, None)
    machine = make_machine(bundle.nodes, [bundle.requirements[0].root], bundle.time)
    assert list(machine.windows.values()) == [(2, 4)]
