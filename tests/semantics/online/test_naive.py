"""The naive recursion itself, by hand: it is what everything else is tested with."""

from stlspec.compiler.ir import Builder
from tests.semantics.online.cases import STAMPS, STEP
from tests.semantics.online.naive import Naive

INF = float("inf")


def enclosure(build, x, base=STEP, times=None, ends="any", ranges=None):
    b = Builder()
    root = build(b, b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)]))
    times = list(range(len(x))) if times is None else times
    naive = Naive(b.nodes, base, {"x": x}, times, {"x": (-1.0, 9.0)} if ranges is None else ranges, ends)
    return naive.enclosure(root, 0)


def test_the_examples_of_the_design():
    assert enclosure(lambda b, p: b.add("always", [p], interval=(0, 10)), [3.0, 2.0, 4.0], ranges={}) == (-INF, 2.0)
    late = lambda b, p: b.add("eventually", [p], interval=(5, 10))  # noqa: E731
    assert enclosure(late, [3.0] * 5) == (-INF, 9.0)
    assert enclosure(late, [3.0] * 6) == (3.0, 9.0)


def test_a_next_sample_may_not_come():
    assert enclosure(lambda b, p: b.add("next", [p]), [3.0]) == (-INF, 9.0)
    assert enclosure(lambda b, p: b.add("next", [p]), [3.0], ends="horizon") == (-1.0, 9.0)
    assert enclosure(lambda b, p: b.add("next", [p]), [3.0, 1.0]) == (1.0, 1.0)


def test_uneven_samples_may_come_until_the_window_has_passed():
    build = lambda b, p: b.add("always", [p], interval=(0, 5))  # noqa: E731
    assert enclosure(build, [3.0, 2.0], STAMPS, [0, 4]) == (-1.0, 2.0)
    assert enclosure(build, [3.0, 2.0], STAMPS, [0, 7]) == (3.0, 3.0)
