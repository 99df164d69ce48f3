import json

import pytest

from stlspec.paper.cases import TABLE_1, case_of
from stlspec.paper.experiments import EXPERIMENTS, OPTIONS, make_either, rows_from_json, rows_to_json, unseen
from stlspec.paper.irl import IrlResult
from stlspec.paper.maps import cells
from stlspec.paper.runs import Run


def run(name, made):
    seen = []
    result = EXPERIMENTS[name].run(made.tiny, 1, lambda number, count: seen.append((number, count)))
    assert seen
    return json.loads(json.dumps(result, allow_nan=False))


def test_rows_survive_being_kept(made):
    rows = {"grid-5": {"shaped": made.rows(5, None)}}
    assert rows_from_json(json.loads(json.dumps(rows_to_json(rows)))) == rows


def test_every_row_of_table_1_is_an_experiment():
    assert [name for name in EXPERIMENTS if name.startswith("table-1-")] == [f"table-1-{name}" for name in TABLE_1]
    assert all(key == found.name for key, found in EXPERIMENTS.items())


def test_lakes_are_learned_by_every_method_from_every_seed(made):
    rows = rows_from_json(run("lakes", made))
    assert list(rows) == ["lake-4", "lake-8"]
    for by in rows.values():
        assert set(by) == {"shaped", "plain", "shaped, no mask", "standard"} <= set(OPTIONS)
        assert all([row.seed for row in found] == [0, 1] for found in by.values())
        assert all(row.success for row in by["shaped"])
        assert max(row.violations for row in by["shaped"]) < min(row.violations for row in by["standard"])


def test_hand_crafted_rewards_are_learned_beside_ours(made):
    runs = [Run("lake-4", method, case_of("lake-4"), 1) for method in ("shaped", "sparse", "by distance")]
    shaped, sparse, dense = map(make_either, runs)
    assert shaped.to_success != sparse.to_success
    assert {shaped.success, sparse.success, dense.success} == {True}
    plain = make_either(Run("lake-4", "plain", case_of("lake-4"), 1, options=OPTIONS["plain"]))
    assert (sparse.to_success, sparse.env_steps) == (plain.to_success, plain.env_steps)


def test_mountain_car_is_learned_within_its_budget(made):
    by = rows_from_json(run("car-75", made))["car-75"]
    assert {method: len(found) for method, found in by.items()} == {"shaped": 1, "plain": 1, "standard": 1}
    assert all(row.episodes == 2 and row.env_steps == 40 and row.probability == 0 for (row,) in by.values())


def test_demonstrations_are_scored_for_every_seed_and_size(made):
    found = run("demonstrations", made)
    assert len(found["worth"]) == 2 * 3 * 5
    assert {row["label"] for row in found["worth"]} == {"good", "bad", "incomplete"}
    assert [row["states"] for row in found["times"].values()] == [25, 100, 400, 1600, 6400]


@pytest.mark.parametrize(("name", "has_truth"), [("grid-5", True), ("lake-4", False)])
def test_a_row_of_table_1_has_times_and_where_there_is_one_the_ground_truth(made, name, has_truth, monkeypatch):
    asked = []

    def answer(case, experts, *, iterations, seconds):
        asked.append((case.name, len(experts), iterations, seconds))
        return IrlResult(None, 3, 3, 0.5, reward=tuple(map(float, range(25))), demonstrations=len(experts))

    monkeypatch.setattr("stlspec.paper.experiments.measure", answer)
    found = run(f"table-1-{name}", made)
    assert 0 < found["ours"]["seconds"] < found["ours"]["cold"]
    assert (found["truth"] is not None) is has_truth
    assert ("correlation" in found["ours"]) is has_truth is ("correlation" in found["irl"])
    assert asked == [(name, {"grid-5": 70, "lake-4": 150}[name], 3, 1.0)]
    assert found["irl"]["seconds"] == 0.5


def test_the_baseline_gets_more_and_more_demonstrations(made, monkeypatch):
    def answer(case, experts, *, iterations, seconds):
        return IrlResult(None, reward=(0.0,) * 24 + (float(len(experts)),), seconds=1.0)

    monkeypatch.setattr("stlspec.paper.experiments.measure", answer)
    found = run("irl-demos", made)
    assert found["counts"] == [3, 10, 30, 70]
    assert [row["reward"][-1] for row in found["rows"]] == [3, 10, 30, 70]
    assert [row["correlation"] for row in found["rows"]] == pytest.approx([found["rows"][0]["correlation"]] * 4)


def test_without_the_libraries_of_the_baseline_a_row_says_what_is_missing(made, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    found = run("table-1-grid-5", made)
    assert found["irl"]["seconds"] is found["irl"]["reward"] is found["irl"]["correlation"] is None
    assert "stlspec.paper.libraries" in found["irl"]["skipped"]


@pytest.mark.parametrize("name", ["lake-4", "lake-8"])
def test_unseen_maps_move_the_holes_and_nothing_else(name):
    home, maps = case_of(name).map, [case.map for case in unseen(name)]
    assert len({home, *maps}) == 4
    for rows in maps:
        assert len(cells(rows, "H")) == len(cells(home, "H"))
        assert cells(rows, "SG") == cells(home, "SG")


def test_the_reward_of_mce_irl_is_put_to_use_where_it_was_found(made, monkeypatch):
    def answer(case, experts, *, iterations, seconds):
        if case.name == "grid-7":
            return IrlResult("no network")
        assert (len(experts), iterations, seconds) == (800, 3, 4.0)
        return IrlResult(None, 3, 3, 0.5, reward=tuple(map(float, range(64))), note="converged")

    monkeypatch.setattr("stlspec.paper.experiments.measure", answer)
    found = run("rewards", made)
    assert found["notes"] == {"grid-7": "no network", "lake-8": "converged"}
    assert {name: by["STL reward"]["maps"] for name, by in found["asked"].items()} == {"lake-8": 2}
    rows = rows_from_json(found["rows"])
    assert list(rows) == ["lake-8, demonstrated", "lake-8, unseen 1", "lake-8, unseen 2"]
    assert all(len(found) == 2 for by in rows.values() for found in by.values())
