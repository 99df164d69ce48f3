"""Whole runs of the learner."""

import json
import math
import random
from dataclasses import replace
from pathlib import Path

import pytest

from stlspec import api
from stlspec.demos import load_demonstrations
from stlspec.envs.catalogue import make_environment, read_map
from stlspec.errors import DataError, UsageError
from stlspec.learning import learn, segments
from stlspec.rewards import infer_reward


def without_time(outcome):
    return replace(outcome, evaluation=None, training=replace(outcome.training, seconds=0.0))


@pytest.mark.parametrize("number", range(6))
def test_shaped_learning_meets_every_requirement_on_the_public_maps(kit, number):
    item = kit.public_items()[number]
    bundle, world, demos = kit.item_parts(item)
    for seed in (0, 1):
        outcome = learn(bundle, world, demos, seed=seed)
        assert outcome.success
        assert outcome.meets_hard
        assert len(outcome.actions) == item["t_goal_bfs"]
        assert outcome.training.hard_violations <= 4 * len(item["obstacles"])


@pytest.mark.parametrize("number", range(4))
def test_two_goals_are_reached_in_the_shortest_time(kit, number):
    """T_goal is the shortest possible, so the path must be optimal over both orders."""
    item = kit.public_items("grid-two-goal")[number]
    for seed in (0, 1):
        outcome = learn(*kit.tour_parts(item), seed=seed)
        assert outcome.success
        assert len(outcome.actions) == item["t_goal_bfs"]
        assert sorted(outcome.goal_order) == ["d_goal_1 < 1", "d_goal_2 < 1"]


@pytest.mark.parametrize(("goals", "size"), [(2, 6), (3, 5), (3, 8)])
def test_several_goals_on_fresh_random_maps_too(kit, goals, size):
    """The bound is the shortest tour over all orders."""
    for number in range(2):
        bundle, world, demos = kit.random_tour(size, goals, f"test{number}")
        outcome = learn(bundle, world, demos, seed=number)
        assert outcome.success, (goals, size, number)


@pytest.mark.parametrize("size", [5, 7, 10])
def test_it_holds_on_fresh_random_maps(kit, size):
    for number in range(3):
        bundle, world, demos, obstacles = kit.random_task(size, f"test{number}")
        outcome = learn(bundle, world, demos, seed=number)
        assert outcome.success
        assert outcome.training.hard_violations <= 4 * obstacles


def test_demonstrations_cut_the_steps_to_success_on_large_maps(kit):
    """Median over six runs at 10x10: at most a third of what the matched baseline needs."""
    ratios = []
    for number in range(6):
        bundle, world, demos, _ = kit.random_task(10, f"ratio{number}")
        shaped, plain = (learn(bundle, world, demos, method=m, episodes=2500) for m in ("shaped", "plain"))
        ratios.append(shaped.training.env_steps_to_success / plain.training.env_steps_to_success)
    assert sorted(ratios)[3] <= 1 / 3


@pytest.mark.parametrize("rows", [("SFFF", "FHFH", "FFFH", "HFFG"), ("SFFF", "FHFH", "FFFF", "FHHG")])
def test_demonstrations_of_one_lake_help_on_another(kit, rows):
    """The second lake is unseen: the reward carries over, the mask does not."""
    home = kit.frozen_lake(("SFFF", "FHFH", "FFFH", "HFFG"))
    path = [[0, 0], [1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [3, 3]]
    demos = kit.demonstrations([path, [[0, 0], [1, 0], [1, 1]]])
    world = kit.frozen_lake(rows)
    outcome = learn(kit.grid_bundle(6), world, demos, demo_environment=home, episodes=1000)
    assert outcome.success
    assert outcome.training.prefilled == (1 if rows == home.map else 0)


def test_a_lake_that_misleads_costs_little(kit):
    """A fixed potential needed 1400 steps here, plain learning 350: right of (0, 2) is the way, down was it."""
    home = kit.frozen_lake(("SFFF", "FHFH", "FFFH", "HFFG"))
    world = kit.frozen_lake(("SFFF", "HHHF", "FFFF", "FFFG"))
    demos = kit.demonstrations([[(0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (3, 2), (3, 3)]])
    for seed in range(3):
        outcome = learn(kit.grid_bundle(6), world, demos, episodes=500, seed=seed, demo_environment=home)
        assert outcome.success
        assert outcome.training.env_steps_to_success < 500


@pytest.mark.parametrize("method", ["shaped", "plain", "paper"])
def test_the_same_seed_gives_the_same_run(small, method):
    bundle, world, demos = small
    first, again, other = (
        without_time(learn(bundle, world, demos, method=method, seed=s, episodes=200)) for s in (3, 3, 4)
    )
    assert first == again
    assert first.log != other.log


def test_a_map_without_obstacles_is_learned_too(kit):
    world = kit.grid_world(("....G", ".....", "S...."))
    demos = kit.demonstrations([[[2, 0], [1, 0], [0, 0], [0, 1], [0, 2], [0, 3], [0, 4]]])
    for method in ("shaped", "plain"):
        assert learn(kit.grid_bundle(6), world, demos, method=method, episodes=500).success
    paper = learn(kit.grid_bundle(6), world, demos, method="paper", episodes=500)
    assert all(math.isfinite(value) for row in paper.policy.q for value in row)


def test_a_given_reward_replaces_demonstrations(small):
    bundle, world, demos = small
    reward = infer_reward(bundle, demos, world)
    outcome = learn(bundle, world, reward=reward, episodes=500)
    assert outcome.success
    assert outcome.reward == reward
    assert outcome.training.prefilled == 0


def test_a_reward_of_a_larger_map_is_refused(small, kit):
    bundle, world, demos = small
    reward = infer_reward(bundle, demos, world)
    with pytest.raises(DataError) as caught:
        learn(bundle, kit.grid_world(("S..", "...", "..G")), reward=reward)
    assert caught.value.diagnostics[0].code == "D862"


def test_without_demonstrations_it_learns_and_warns(small):
    bundle, world, _ = small
    outcome = learn(bundle, world, episodes=1000)
    assert outcome.success
    assert [w.code for w in outcome.warnings] == ["D864"]
    assert learn(bundle, world, episodes=30, method="plain").warnings == ()


def test_an_impossible_bound_is_reported_and_the_best_path_returned(kit):
    item = kit.public_items()[0]
    _, world, demos = kit.item_parts(item)
    outcome = learn(kit.grid_bundle(item["t_goal_bfs"] - 1), world, demos)
    assert not outcome.success
    assert outcome.meets_hard
    assert outcome.training.env_steps_to_success is None
    assert outcome.evaluation["reach"].verdict == "satisfied"
    assert outcome.evaluation["fast"].verdict == "violated"


def test_a_goal_behind_obstacles_gives_no_success_and_few_violations(kit):
    world = kit.grid_world(("S.#G", "..##", "...."))
    outcome = learn(kit.grid_bundle(5), world, episodes=300)
    assert not outcome.success
    assert outcome.training.hard_violations <= 4 * 3
    assert outcome.meets_hard


def test_a_start_that_violates_is_no_success(kit):
    bundle = api.compile(
        "signal d_goal\nhard away: always (d_goal > 1)\nsoft home depends on away: eventually (d_goal < 1)"
    )
    outcome = learn(bundle, kit.grid_world(("SG", "..")), episodes=30)
    assert not outcome.success
    assert not outcome.meets_hard
    assert outcome.training.env_steps == 0
    assert outcome.actions == ()
    assert "the start itself violates" in outcome.notes[-1]


def test_a_start_at_the_goal_is_a_success_without_steps(kit):
    bundle = api.compile("signal d_goal\nsoft near: eventually (d_goal <= 2)")
    outcome = learn(bundle, kit.grid_world(("S.", ".G")), episodes=30)
    assert outcome.success
    assert (outcome.training.env_steps, outcome.training.env_steps_to_success) == (0, 0)


def naive_paper_return(world, path, reward, gamma, skip):
    """Sum the paper's reward along a path by its definition; the first `skip` steps only count for rho."""
    distances = world.signals(["d_obs"], path)["d_obs"] - 1
    total = 0.0
    for k in range(skip + 1, len(path)):
        total += gamma ** (k - skip - 1) * (reward[path[k]] + min(distances[: k + 1]))
    return total


@pytest.mark.parametrize("number", [0, 2])
def test_the_paper_s_method_farms_and_shows_that_it_pays(kit, number):
    """Both returns are recomputed by summing the printed reward step by step."""
    item = kit.public_items()[number]
    bundle, world, demos = kit.item_parts(item)
    outcome = learn(bundle, world, demos, method="paper", episodes=1500)
    assert not outcome.success
    farming = outcome.farming
    assert farming is not None
    assert farming.return_cycle > farming.return_goal
    entry = outcome.states.index(farming.cycle[0])
    before = list(outcome.states[: entry + 1])
    reward = outcome.reward.table(world)
    laps = [*farming.cycle[1:], farming.cycle[0]] * (4000 // len(farming.cycle))
    circling = naive_paper_return(world, before + laps, reward, 0.99, entry)
    assert farming.return_cycle == pytest.approx(circling, rel=1e-6)
    direct = naive_paper_return(world, before + list(farming.to_goal[1:]), reward, 0.99, entry)
    assert farming.return_goal == pytest.approx(direct)
    assert "farms" in outcome.notes[-1]
    assert outcome.to_json()["farming"]["cycle"][0] == list(outcome.path[entry])


def test_where_the_paper_s_method_does_not_farm_it_says_so():
    """In the corridor nothing but arriving pays: every cell touches an obstacle, so rho is 0 throughout, and
    the demonstration holds the goal alone, so no cell before it has a reward."""
    specs = Path(__file__).parents[2] / "specs"
    bundle = api.compile(specs / "grid_single_goal.stl")
    world = make_environment("stlspec/GridWorld-v0", None, read_map(specs / "maps" / "corridor.txt"))
    demos = load_demonstrations([specs / "demos" / "corridor.jsonl"])
    outcome = learn(bundle, world, demos, method="paper", episodes=300)
    assert outcome.path == ((0, 0), (0, 1), (0, 2))
    assert outcome.farming is None
    assert "does not farm" in outcome.notes[-1]
    assert outcome.to_json()["farming"] is None


def test_steps_to_success_agree_with_the_log_and_the_checks(small):
    bundle, world, demos = small
    outcome = learn(bundle, world, demos, episodes=110)
    assert [c[0] for c in outcome.checks] == [25, 50, 75, 100, 110]
    for episodes, steps, _ in outcome.checks:
        assert steps == sum(outcome.log.steps[:episodes])
    assert outcome.training.env_steps_to_success == sum(outcome.log.steps[: outcome.training.episodes_to_success])


def test_progress_is_told_between_chunks(small):
    calls = []
    outcome = learn(*small, episodes=60, progress=lambda *numbers: calls.append(numbers))
    assert [c[:2] for c in calls] == [(25, 60), (50, 60), (60, 60)]
    assert calls[-1][2] == outcome.training.env_steps


class StopHereError(Exception):
    pass


def stop_at(episode):
    def progress(done, _total, _steps):
        if done >= episode:
            raise StopHereError

    return progress


@pytest.mark.parametrize("method", ["shaped", "plain", "paper"])
def test_an_interrupted_run_resumes_bit_for_bit(small, tmp_path, monkeypatch, method):
    """Interrupted at two random places, the third attempt equals a run in one go, but for the seconds."""
    monkeypatch.setattr(segments, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(segments, "CHECKPOINT_SHARE", math.inf)
    bundle, world, demos = small
    given = {"method": method, "episodes": 400, "seed": 7}
    whole = learn(bundle, world, demos, out=tmp_path / "whole", **given)
    draw = random.Random(method)
    for stop in sorted((draw.randrange(25, 200), draw.randrange(200, 390))):
        with pytest.raises(StopHereError):
            learn(bundle, world, demos, out=tmp_path / "out", progress=stop_at(stop), **given)
        assert not (tmp_path / "out").exists()
        assert list((tmp_path / "out.partial").glob("segment-*.json"))
    calls = []
    resumed = learn(bundle, world, demos, out=tmp_path / "out", progress=lambda *n: calls.append(n), **given)
    assert calls[0][0] > 200
    assert without_time(resumed) == without_time(whole)
    for name in ("policy.json", "reward.json", "episodes.csv"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    first, second = (json.loads((tmp_path / d / "result.json").read_text()) for d in ("out", "whole"))
    del first["training"]["seconds"], second["training"]["seconds"]
    assert first == second
    assert not (tmp_path / "out.partial").exists()


@pytest.mark.parametrize("damage", ["other", "cut"])
def test_a_checkpoint_of_another_run_or_a_damaged_one_is_ignored(small, tmp_path, monkeypatch, damage):
    monkeypatch.setattr(segments, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(segments, "CHECKPOINT_SHARE", math.inf)
    bundle, world, demos = small
    with pytest.raises(StopHereError):
        seed = 1 if damage == "other" else 0
        learn(bundle, world, demos, episodes=200, seed=seed, out=tmp_path / "o", progress=stop_at(100))
    if damage == "cut":
        (place,) = (tmp_path / "o.partial").glob("segment-*.json")
        place.write_bytes(place.read_bytes()[:-40])
    outcome = learn(bundle, world, demos, episodes=200, out=tmp_path / "o")
    assert without_time(replace(outcome, files={})) == without_time(
        replace(learn(bundle, world, demos, episodes=200), files={})
    )


def test_an_output_that_is_something_else_is_refused_before_training(small, tmp_path):
    (tmp_path / "mine.txt").write_text("keep")
    calls = []
    with pytest.raises(UsageError) as caught:
        learn(*small, out=tmp_path, progress=lambda *n: calls.append(n))
    assert caught.value.diagnostics[0].code == "D872"
    assert calls == []


def test_a_spec_in_seconds_is_refused_before_training(kit, small):
    bundle = api.compile("time s\nsignal d_goal\nsoft a: eventually[0 s, 5 s] (d_goal < 1)")
    with pytest.raises(UsageError) as caught:
        learn(bundle, small[1])
    assert caught.value.diagnostics[0].code == "D876"


def test_hard_requirements_with_memory_are_kept(kit):
    """The short way leads from the wet cell into the dry one; for 2 steps after wet, dry is forbidden."""
    text = "signal in_w: bool\nsignal in_d: bool\nsignal d_goal\n{}soft home: eventually (d_goal < 1)"
    world = kit.grid_world(("Swd.G", "....."))
    outcome = learn(api.compile(text.format("hard drip: always (once[0, 2] in_w implies not in_d)\n")), world)
    assert outcome.success
    assert len(outcome.actions) == 6
    assert outcome.training.hard_violations > 0
    assert outcome.policy.route is not None
    assert len(learn(api.compile(text.format("")), world).actions) == 4


def test_the_number_of_processes_is_checked(small):
    for jobs in (0, 257, True, "two"):
        with pytest.raises(UsageError) as caught:
            learn(*small, jobs=jobs)
        assert caught.value.diagnostics[0].code == "D871"


def test_masking_can_be_turned_off(small):
    bundle, world, demos = small
    masked, free = (learn(bundle, world, demos, episodes=500, mask=m) for m in (True, False))
    assert free.training.masked == 0
    assert free.training.hard_violations > 5 * masked.training.hard_violations
