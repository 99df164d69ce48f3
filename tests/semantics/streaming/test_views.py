"""A view evaluates a piece; what decides may lie before it."""

import numpy as np

from stlspec import api
from stlspec.semantics.streaming.pieces import Pieces
from stlspec.semantics.streaming.views import Finding, Label, Past, View, reason

LABEL = Label(1, 2, False, 1.0, (7.0, 4.0))


def view_of(text, x, drop=0, pasts=None, ended=True):
    bundle = api.compile(text)
    held = Pieces(bundle, None)
    held.add({"x": x}, None, len(x))
    trace = held.joined()
    if drop:
        held.drop(drop)
        trace = held.joined()
    return bundle, View(bundle.nodes, range(len(bundle.nodes)), trace, pasts or {}, ended)


def test_findings_merge_to_the_earliest_and_turn_round_under_negation():
    later = Label(4, 0, True, 4.0, (1.0, 2.0))
    both = Finding(later).merged(Finding(LABEL, ran_out=True))
    assert both == Finding(LABEL, ran_out=True)
    assert both.seen_from(-1.0).label.negated and both.seen_from(1.0) == both
    assert Finding().seen_from(-1.0) == Finding()


def test_a_past_takes_part_in_values_and_in_what_decides():
    text = "signal x\nhard r: always (x < 0 or once (x > 4))\n"
    bundle, plain = view_of(text, [1, 7, 2, 3, 3])
    once = next(i for i, n in enumerate(bundle.nodes) if n.op == "once")
    _, view = view_of(text, [1, 7, 2, 3, 3], drop=2, pasts={once: Past(3, 3.0, Finding(LABEL))})
    assert plain.values[once].tolist() == [-3, 3, 3, 3, 3]
    assert view.values[once][1:].tolist() == [3, 3]
    start = np.array([False, True, True])
    assert view.deciding(once, start, 3.0).label == LABEL
    assert view.decided_before(Finding(Label(0, 2, False, 0.0, ()))) and not view.decided_before(Finding(LABEL))


def test_an_expression_is_asked_for_only_where_it_is_exact():
    # At the cut there is no value before, and delta(x) / (x - 4) would be 0 / 0, which the whole never is.
    text = "signal x\nhard r: always (delta(x) / (x - 4) > 0)\n"
    bundle, view = view_of(text, [1, 2, 4, 8], drop=1)
    delta, quotient = (next(i for i, n in enumerate(bundle.nodes) if n.op == op) for op in ("delta", "div"))
    assert view.values[delta].tolist() == [0, 0, 4]
    assert view.values[quotient].tolist()[2:] == [1]


def test_a_finding_says_why():
    bundle, view = view_of("signal x\nhard r: always (x > 4)\n", [9, 3, 3])
    root = next(i for i, n in enumerate(bundle.nodes) if n.op == "gt")
    found = view.deciding(root, np.array([False, True, True]), -1.0)
    assert found.label.sample == 1 and reason(bundle, found.label) == "x = 3, needs > 4"


def test_a_rate_is_in_the_unit_that_was_written():
    text = 'time 100 ms\nsignal x unit "m"\nhard r: always (rate(x) > 3 m/s)\n'
    bundle, view = view_of(text, [1, 1.5, 1.6])
    root = next(i for i, n in enumerate(bundle.nodes) if n.op == "gt")
    found = view.deciding(root, np.array([False, False, True]), float(view.values[root][2]))
    assert reason(bundle, found.label) == "rate(x) = 1 m/s, needs > 3 m/s"
