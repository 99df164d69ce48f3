import itertools
import random

import pytest

from stlspec.paper.maps import (
    bad_path,
    cells,
    distances,
    free,
    good_path,
    least_steps,
    moved_holes,
    random_map,
    roundabout_path,
    shortest,
    unfinished_path,
)

SMALL = ("..G", ".#.", "S..")
TOUR = ("S.1", ".#.", "..2")


def is_walk(path):
    return all(abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1 for a, b in itertools.pairwise(path))


def test_cells_come_by_mark_then_by_place():
    assert cells(("2.1", "..#"), "12") == ((0, 2), (0, 0))
    assert cells(SMALL, "#H") == ((1, 1),)


def test_distances_count_steps_around_obstacles():
    assert distances(free(("S#", "..")), (0, 0)) == {(0, 0): 0, (1, 0): 1, (1, 1): 2}


@pytest.mark.parametrize(("rows", "steps"), [(SMALL, 4), (TOUR, 4), (("S1", "#2"), 2), (("1S2",), 3)])
def test_least_steps_take_the_best_order_of_goals(rows, steps):
    assert least_steps(rows) == steps


def test_a_map_without_a_way_is_refused():
    with pytest.raises(ValueError, match="no way"):
        least_steps(("S#G",))
    with pytest.raises(ValueError, match="no way"):
        shortest(free(("S#G",)), ((0, 0), (0, 2)), random.Random(0))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("goals", [1, 2])
def test_paths_keep_what_their_kind_promises(seed, goals):
    draw = random.Random(seed)
    rows = random_map(6, goals, 6, draw)
    assert len(cells(rows, "#")) == 6
    assert cells(rows, "S") == ((5, 0),)
    least, targets = least_steps(rows), set(cells(rows, "G12"))
    good, around, bad = good_path(rows, draw), roundabout_path(rows, draw), bad_path(rows, draw)
    half = unfinished_path(rows, draw)
    assert len(good) - 1 == least < len(around) - 1 <= 2 * least
    for path in (good, around, bad, half):
        assert is_walk(path)
        assert path[0] == (5, 0)
    assert targets <= set(good)
    assert targets <= set(around)
    assert not targets <= set(half)
    assert {*good, *around, *half} <= free(rows)
    assert len(set(bad) - free(rows)) == 1


def test_a_bad_path_on_a_lake_ends_in_the_hole():
    rows = ("SFF", "FHF", "FFG")
    assert bad_path(rows, random.Random(0))[-1] == (1, 1)


def test_what_a_map_cannot_have_is_refused():
    with pytest.raises(ValueError, match="shortest"):
        roundabout_path(("S.G",), random.Random(0))
    with pytest.raises(ValueError, match="reached"):
        bad_path(("S.G",), random.Random(0))


def test_shortest_paths_differ_from_draw_to_draw_and_not_for_a_seed():
    draw = random.Random(1)
    found = {good_path(SMALL, draw) for _ in range(30)}
    assert found == {
        ((2, 0), (1, 0), (0, 0), (0, 1), (0, 2)),
        ((2, 0), (2, 1), (2, 2), (1, 2), (0, 2)),
    }
    assert good_path(SMALL, random.Random(5)) == good_path(SMALL, random.Random(5))


@pytest.mark.parametrize("seed", range(10))
def test_holes_move_and_the_goal_can_still_be_reached(seed):
    rows = ("SFFH", "FHFH", "FFFH", "HFFG")
    moved = moved_holes(rows, random.Random(seed))
    assert (cells(moved, "S"), cells(moved, "G")) == (((0, 0),), ((3, 3),))
    assert len(cells(moved, "H")) == 5
    assert least_steps(moved) >= 6
