"""Open samples where samples are counted, and the numbers that are kept for those who ask again and again."""

from stlspec.compiler.bundle import Requirement, Signal
from stlspec.compiler.ir import Builder
from stlspec.semantics.online.counted import Counted
from stlspec.semantics.online.plan import make_plan
from tests.semantics.online.cases import bundle_of


def counted():
    """a: always[1, 3] x > 0; b: x > 0; c: eventually x > 0, without end."""
    b = Builder()
    p = b.add("gt", [b.add("signal", value="x"), b.add("const", value=0.0)])
    roots = {"a": b.add("always", [p], interval=(1, 3)), "b": p, "c": b.add("eventually", [p], interval=(0, None))}
    requirements = tuple(Requirement(name, "hard", root) for name, root in roots.items())
    spec = bundle_of(tuple(b.nodes), requirements, (Signal("x"),))
    return Counted(spec, make_plan(spec))


def test_the_first_open_sample_follows_from_the_number_of_samples():
    assert [counted().first_open(n) for n in (0, 1, 3, 9)] == [[0, 0, 0], [0, 1, 0], [0, 3, 0], [6, 9, 0]]


def test_each_requirement_is_enclosed_at_its_open_samples():
    opening = counted()
    opening.tape.columns[0].extend([4.0, 2.0, 3.0, 1.0])
    inf = float("inf")
    shown = [(first, [c.tolist() for c in columns]) for first, columns in opening.shown_samples(4)]
    assert shown == [
        (1, [[-inf] * 3, [1.0, 1.0, inf], [1.0, 1.0, inf]]),
        (4, [[], [], []]),
        (0, [[4.0, 3.0, 3.0, 1.0], [inf] * 4, [4.0, 3.0, 3.0, 1.0]]),
    ]


def test_numbers_and_times_are_views_that_move_on():
    opening = counted()
    seen = [opening.positions(first, first + 3)[0] for first in (0, 1, 997, 998, 5000, 4)]
    assert [x.tolist() for x in seen] == [[f, f + 1, f + 2] for f in (0, 1, 997, 998, 5000, 4)]
    assert opening.positions(4, 6)[1].tolist() == [4.0, 5.0]
    assert not seen[0].flags.writeable
    assert opening.positions(2, 2)[0].tolist() == []
