import pytest

from stlspec.paper.cases import BAD, KINDS, case_of, random_grid
from stlspec.paper.runs import Run, groups, make_run, make_runs


@pytest.mark.parametrize("episodes", [1, 2, 59, 5000])
def test_groups_cover_every_episode_once_and_grow(episodes):
    found = groups(episodes)
    assert [k for first, end in found for k in range(first, end)] == list(range(episodes))
    assert len(found) <= 61


def run_of(seed=0, method="shaped", **fields):
    case = random_grid(5, 1, KINDS["grid-5"], 0)
    return Run("a group", method, case, seed, options={"method": method, "episodes": 200}, **fields)


def test_a_run_becomes_a_row_of_its_figures():
    row = make_run(run_of())
    assert (row.success, row.hard, row.reached, row.late, row.probability) == (True, True, True, 0, None)
    assert row.path == 8
    assert 0 < row.to_success <= row.env_steps
    assert row.episodes_to_success % 25 == 0
    assert sum(mean * (end - first) for mean, (first, end) in zip(row.curve, groups(200), strict=True)) == (
        pytest.approx(row.env_steps)
    )
    assert row.mean_steps == row.env_steps / 200
    assert row.prefilled == 1


def test_only_the_demonstrations_that_are_asked_for_count():
    assert make_run(run_of(kinds=("good",))).prefilled == 0
    assert make_run(run_of(kinds=(BAD,))).prefilled == 1
    assert make_run(run_of(none=True)).prefilled == 0


def test_demonstrations_of_another_map_forbid_nothing_here():
    other = run_of().case
    moved = other.on_map(("....G", ".#...", ".....", "...#.", "S...."))
    row = make_run(Run("g", "shaped", moved, 0, other, options={"episodes": 100}))
    assert row.prefilled == 0


def test_several_goals_make_no_single_curve():
    case = case_of("two-goal-5")
    assert make_run(Run("g", "shaped", case, 0, options={"episodes": 50})).curve == ()


def test_rows_do_not_depend_on_the_number_of_processes():
    runs = [run_of(seed, method) for method in ("shaped", "plain") for seed in range(2)]
    seen = []
    one = make_runs(runs, 1, lambda number, count: seen.append((number, count)))
    two = make_runs(runs, 2)
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert list(one) == ["a group"]
    for method in ("shaped", "plain"):
        pairs = zip(one["a group"][method], two["a group"][method], strict=True)
        assert [row.seed for row in one["a group"][method]] == [0, 1]
        assert all((a.to_success, a.curve, a.path) == (b.to_success, b.curve, b.path) for a, b in pairs)
