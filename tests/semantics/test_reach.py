"""How far ahead a formula looks before an operator without end."""

import pytest

from stlspec.compiler.bundle import TimeBase
from stlspec.compiler.ir import Builder
from stlspec.semantics.reach import bounded_reach

STEP = TimeBase("step", "step", 1)
PERIOD = TimeBase("period", "ms", 10**6, period=100 * 10**6)
STAMPS = TimeBase("stamps", "s", 10**9)


def reach(tree, base=STEP):
    builder = Builder()

    def add(term):
        if term == "p":
            return builder.add("bool", value="b")
        op, *rest = term
        interval = rest.pop() if op not in ("not", "and", "or", "next", "prev") else None
        return builder.add(op, [add(t) for t in rest], interval=interval)

    root = add(tree)
    return bounded_reach(builder.nodes, base)[root]


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        ("p", 0),
        (("always", "p", (0, 8)), 8),
        (("always", "p", (3, None)), 3),
        (("always", ("eventually", "p", (1, 2)), (0, 8)), 10),
        (("until", ("always", "p", (0, 4)), "p", (2, 5)), 9),
        (("and", "p", ("not", ("next", "p"))), 1),
        (("prev", ("next", "p")), 0),
        (("historically", ("eventually", "p", (0, 3)), (2, 4)), 1),
        (("once", "p", (2, 4)), 0),
        (("since", ("eventually", "p", (0, 3)), ("eventually", "p", (0, 9)), (4, None)), 5),
    ],
)
def test_bounded_operators_add_up_and_past_ones_look_back(tree, expected):
    assert reach(tree) == expected


def test_next_is_one_period_and_with_stamps_one_tick():
    assert reach(("next", "p"), PERIOD) == 100 * 10**6
    assert reach(("next", "p"), STAMPS) == 1
    assert reach(("prev", ("next", "p")), STAMPS) == 1
