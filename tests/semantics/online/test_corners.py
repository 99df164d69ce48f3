"""Queues of tables of corners, against formulas of min and max."""

import random

from stlspec.semantics.online.corners import Tables, changed, value_at

INF = float("inf")


def table_of(formula, count):
    return [formula([INF if m >> i & 1 else -INF for i in range(count)]) for m in range(2**count)]


def formulas(rng):
    """Random lattice polynomials of three unknowns."""
    a, b, c = (rng.random() for _ in range(3))
    return rng.choice(
        [
            lambda x: max(a, x[0], min(x[1], x[2])),
            lambda x: min(max(a, x[0]), max(b, x[1]), x[2]),
            lambda x: max(min(x[0], b), min(x[1], c), min(x[2], a)),
        ]
    )


def test_corners_fix_a_formula_of_min_and_max():
    rng = random.Random(1)
    for _ in range(300):
        formula = formulas(rng)
        point = [rng.choice([-INF, INF, rng.random()]) for _ in range(3)]
        assert value_at(table_of(formula, 3), point) == formula(point)


def test_a_clamp_of_an_unknown_mixes_corners():
    rng = random.Random(2)
    for _ in range(300):
        formula = formulas(rng)
        low, high = sorted(rng.random() for _ in range(2))
        unknown = rng.randrange(3)
        table = changed(table_of(formula, 3), [(unknown, low, high)])
        point = [rng.random() for _ in range(3)]
        moved = [max(low, min(high, x)) if i == unknown else x for i, x in enumerate(point)]
        assert value_at(table, point) == formula(moved)


def test_a_queue_gives_the_least_of_its_tables_and_the_oldest_back():
    rng = random.Random(3)
    for _ in range(60):
        queue, model = Tables(3, forget=True), []
        for time in range(20):
            formula = formulas(rng)
            queue.push(time, table_of(formula, 3))
            model.append((time, table_of(formula, 3)))
            changes = [(i, *sorted(rng.random() for _ in range(2))) for i in rng.sample(range(3), 2)]
            queue.change(changes)
            model = [(t, changed(table, changes)) for t, table in model]
            while model and rng.random() < 0.5:
                assert queue.pop() == model.pop(0)
            point = [rng.random() for _ in range(3)]
            assert queue.value(point) == min((value_at(table, point) for _, table in model), default=INF)
