"""Values are exact where no window reaches beyond a piece; numbers by hand."""

import numpy as np
import pytest

from stlspec.compiler.ir import Builder
from stlspec.semantics.streaming.regions import exact_from, exact_to, wanted_from

TIMES = np.array([0, 1, 2, 4, 8, 9, 10, 12])


def over(op, interval=None):
    """A predicate with an operator over it."""
    builder = Builder()
    x, zero = builder.add("signal", value="x"), builder.add("const", value=0.0)
    p = builder.add("gt", (x, zero))
    children = (p, p) if op in ("until", "since") else (p,)
    root = builder.add(op, children, interval=interval)
    return builder.nodes, root


@pytest.mark.parametrize(
    ("op", "interval", "end"),
    [
        ("always", (0, 0), 8),  # the newest sample is known itself
        ("eventually", (1, 2), 7),  # the window of sample 6 ends at 12, which is there
        ("until", (0, 5), 4),  # of sample 4 it would end at 13
        ("always", (0, None), 0),
        ("next", None, 7),
        ("once", (0, 3), 8),
        ("prev", None, 8),
    ],
)
def test_what_comes_later_leaves_the_last_values_open(op, interval, end):
    nodes, root = over(op, interval)
    assert exact_to(nodes, range(root + 1), TIMES)[root] == end


@pytest.mark.parametrize(
    ("op", "interval", "begin"),
    [
        ("always", (0, 3), 1),
        ("once", (0, 0), 1),
        ("historically", (0, 2), 3),  # the window of sample 3 begins at 2; that of sample 2 at 0, which is not exact
        ("since", (1, 8), 5),
        ("since", (0, None), 8),
        ("prev", None, 2),
    ],
)
def test_what_was_cut_off_makes_the_first_values_inexact(op, interval, begin):
    nodes, root = over(op, interval)
    assert exact_from(nodes, range(root + 1), TIMES, {})[root] == begin


def test_an_operator_that_remembers_is_exact_from_where_it_looks_at_the_piece():
    nodes, root = over("once", (3, None))
    assert exact_from(nodes, range(root + 1), TIMES, {root: 2})[root] == 4  # 8 - 3 is not before 2, 4 - 3 is


@pytest.mark.parametrize(
    ("op", "interval", "sample", "first"),
    [
        ("always", (0, 3), 5, 5),
        ("prev", None, 5, 4),
        ("once", (0, 5), 5, 3),
        ("since", (0, 5), 8, 4),  # a sample to come comes at 13 or later
        ("prev", None, 0, 0),
    ],
)
def test_what_is_looked_at_is_kept(op, interval, sample, first):
    nodes, root = over(op, interval)
    found, remembering = wanted_from(nodes, {root: sample}, TIMES)
    assert found[0] == first and remembering == {}


def test_an_operator_that_remembers_lets_go_of_what_it_has_seen():
    nodes, root = over("historically", (3, None))
    found, remembering = wanted_from(nodes, {root: 5}, TIMES)
    assert found[0] == remembering[root] == 3
