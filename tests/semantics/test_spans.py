"""What one sample of the roots depends on: enough, no more than the windows hold, and whole where it must be."""

import numpy as np
import pytest

from stlspec.compiler.ir import Builder
from stlspec.semantics.spans import needed_spans, read_span
from stlspec.semantics.windows import Grid

EVEN = Grid(np.arange(20, dtype=np.int64) * 3, 3)
UNEVEN = Grid(np.array([0, 1, 4, 9, 16, 25, 36], dtype=np.int64), None)


def spans_of(op, interval, at, grid=EVEN, over="signal"):
    """The span of x in `op[interval] (x >= 1)` at one sample; over: a real operator in between."""
    builder = Builder()
    leaf = builder.add("signal", value="x")
    side = leaf if over == "signal" else builder.add(over, [leaf])
    predicate = builder.add("ge", [side, builder.add("const", value=1.0)])
    operands = [predicate, builder.add("not", [predicate])] if op in ("until", "since") else [predicate]
    root = builder.add(op, operands, interval=interval)
    spans = needed_spans(builder.nodes, range(len(builder.nodes)), [root], grid, at)
    assert spans[root] == (at, at + 1)
    return spans[leaf]


@pytest.mark.parametrize(
    ("op", "interval", "at", "expected"),
    [
        *[(op, (0, 8), 4, (4, 7)) for op in ("always", "eventually", "until")],
        *[(op, (0, 8), 4, (2, 5)) for op in ("historically", "once", "since")],
        *[("always", (6, 9), 4, (4, 8)), ("once", (6, 9), 4, (1, 5))],
        *[("always", (0, None), 4, (4, 20)), ("since", (0, None), 4, (0, 5))],
        *[("eventually", (0, 10**30), 4, (4, 20)), ("once", (0, 10**30), 4, (0, 5))],
        *[("next", None, 4, (4, 6)), ("next", None, 19, (19, 20))],
        *[("prev", None, 4, (3, 5)), ("prev", None, 0, (0, 1))],
        ("not", None, 4, (4, 5)),
    ],
)
def test_an_operator_needs_its_window_and_the_way_to_it(op, interval, at, expected):
    assert spans_of(op, interval, at) == expected


@pytest.mark.parametrize(
    ("op", "interval", "at", "expected"),
    [
        *[("always", (0, 8), 1, (1, 4)), ("always", (0, 7), 1, (1, 3)), ("once", (0, 8), 3, (1, 4))],
        *[("until", (2, 10**30), 3, (3, 7)), ("historically", (0, 10**30), 3, (0, 4))],
    ],
)
def test_uneven_stamps_are_looked_up(op, interval, at, expected):
    assert spans_of(op, interval, at, UNEVEN) == expected


@pytest.mark.parametrize(("over", "expected"), [("abs", (4, 6)), ("sqrt", (0, 20)), ("delta", (0, 20))])
def test_an_expression_that_may_have_no_value_is_needed_everywhere(over, expected):
    assert spans_of("always", (0, 3), 4, over=over) == expected


def test_a_node_with_several_readers_gets_a_range_that_holds_what_each_needs():
    builder = Builder()
    p = builder.add("ge", [builder.add("signal", value="x"), builder.add("const", value=1.0)])
    roots = [builder.add("always", [p], interval=(0, 6)), builder.add("once", [p], interval=(0, 9)), p]
    unread = builder.add("not", [p])
    spans = needed_spans(builder.nodes, range(unread), roots, EVEN, 5)
    assert spans[p] == (2, 8)
    assert spans[unread] == (0, 0)


def test_what_is_read_grows_with_what_is_wanted():
    builder = Builder()
    p = builder.add("ge", [builder.add("signal", value="x"), builder.add("const", value=1.0)])
    node = builder.nodes[builder.add("always", [p], interval=(0, 6))]
    assert read_span(node, (2, 9), EVEN) == (2, 11)
    assert read_span(node, (2, 19), EVEN) == (2, 20)
