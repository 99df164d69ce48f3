"""Hard requirements that no step shows to be violated are told, and only these: `learn` watches the others."""

import random
from itertools import product

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.review import review_source
from stlspec.errors import UsageError
from stlspec.learning.memory import FutureInPastError, at_end, first_state, make_machine, read
from stlspec.source import SourceText
from tests.learning import test_product as learner

HEAD = "signal x\nsignal p: bool\nsignal q: bool\nparam open\n"


def found_in(formula, strength="hard", head=HEAD):
    found = review_source(SourceText.of("s", f"{head}{strength} a: {formula}\n")).diagnostics
    return [d for d in found if d.code == "L608"]


@pytest.mark.parametrize(
    "formula",
    [
        "always p",
        "always[0, 9] p",
        "not eventually (x > 3)",
        "always (once[0, 5] p implies not q)",
        "always (q implies once p)",
        "always (q implies not ((not p) since q))",
        "always (historically p or prev q)",
        "always p and always q",
        "always p or always q",
        "always always[0, 2] p",
        "p",
        "always (q implies delta(x) > 1)",
        "always (rate(x) + delta(x) > 1 and now < 5)",
        "always (p implies eventually[0, 5] q)",
        "always (p implies wnext q)",
        "always next p",
        "p unless q",
        "p release q",
        "p until[0, 5] q",
        "eventually[0, open] p",
        "always[0, open] p",
    ],
)
def test_what_a_step_can_be_seen_to_violate_is_step_wise(formula):
    assert found_in(formula) == []


@pytest.mark.parametrize(
    "formula",
    [
        "eventually p",
        "p until q",
        "always (p implies eventually q)",
        "always eventually[2, inf] p",
        "not (p unless q)",
        "not always p",
        "(eventually p) and always[0, open] q",
        "always once eventually[0, 2] p",
        "always (rate(delta(x)) > 1)",
        "always (rate(x) > now)",
    ],
)
def test_what_waits_for_ever_or_is_refused_is_not(formula):
    assert [d.code for d in found_in(formula)] == ["L608"]
    assert found_in(formula, "soft") == []


def test_all_that_are_not_step_wise_are_one_warning():
    text = HEAD + "hard a: eventually p\nhard b: eventually q\nhard c: always (x > open)\n"
    (found,) = review_source(SourceText.of("s", text)).diagnostics
    assert found.code == "L608" and "`a`, `b`" in found.message and len(found.labels) == 1


@pytest.mark.parametrize(
    "formula",
    [
        "always (once (eventually[0, 2] in_a))",
        "always (delta(delta(row)) < 1)",
        "always (delta(row) < now)",
        "always (delta(row) < 1 and now < 9)",
        "always (once in_a)",
    ],
)
def test_what_the_learner_refuses_is_warned_of(formula):
    try:
        learner.product_of(formula)
        refused = False
    except UsageError as error:
        refused = [found.code for found in error.diagnostics] == ["D868"]
    assert bool(found_in(formula, head=learner.HEAD)) == refused


def made(rng, depth):
    """Return a random formula; windows begin at the sample at hand, so that one can stand still in them."""
    if depth == 0:
        return rng.choice(["p", "q", "not p", "once q", "(p since q)", "historically p"])
    one, other = made(rng, depth - 1), made(rng, depth - 1)
    window = rng.choice(["", "[0, 2]"])
    return rng.choice(
        [
            f"(always{window} {one})",
            f"(eventually{window} {one})",
            f"({one} until{window} {other})",
            f"({one} unless{window} {other})",
            f"({one} and {other})",
            f"({one} or {other})",
            f"(not {one})",
            f"(wnext {one})",
        ]
    )


def stands_still(formula):
    """Tell whether some sample repeated for ever leaves a formula open and violated, by the learner's own machine."""
    bundle = compile_source(SourceText.of("s", f"signal p: bool\nsignal q: bool\nhard a: {formula}\n"))
    machine = make_machine(bundle.nodes, [bundle.requirements[0].root], bundle.time)
    states, pending = {first_state(machine)}, [first_state(machine)]
    while pending:
        state = pending.pop()
        for holds in product((False, True), repeat=len(machine.letters)):
            after = read(machine, state, holds)
            if after == state and after[0][0] is not False and not at_end(machine, after[0][0]):
                return True
            if after not in states:
                states.add(after)
                pending.append(after)
        if len(states) > 100:
            return False
    return False


def test_the_learner_sees_at_a_step_what_no_warning_is_given_of():
    rng, counts = random.Random(5), [0, 0]
    for _ in range(250):
        formula = made(rng, rng.choice([1, 2, 2, 3]))
        try:
            waits = stands_still(formula)
        except FutureInPastError:
            waits = True
        warned = bool(found_in(formula))
        assert warned or not waits, formula
        counts[warned] += 1
    assert min(counts) > 40
