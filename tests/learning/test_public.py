"""Every public demonstration gets the label and the robustness that were worked out for it independently."""

import json
from pathlib import Path

import pytest

from stlspec import api
from stlspec.demos import make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.scores import score

ITEMS = json.loads(Path(__file__).with_name("public.json").read_text())["items"]
CASES = [
    pytest.param(item, demo, id=f"{item['name']}-{number}")
    for item in ITEMS
    for number, demo in enumerate(item["demos"])
    if isinstance(demo, dict) and "label_expected" in demo
]


def world_of(item):
    if item["kind"] == "frozenlake-transfer":
        return make_environment("FrozenLake-v1", {"map_name": item["train_map"], "is_slippery": item["slippery"]})
    rows = [["."] * item["size"] for _ in range(item["size"])]
    marks = {tuple(item["start"]): "S", **{tuple(o): "#" for o in item["obstacles"]}}
    marks |= {tuple(g): str(i) if len(item["goals"]) > 1 else "G" for i, g in enumerate(item["goals"], 1)}
    for (row, column), mark in marks.items():
        rows[row][column] = mark
    return make_environment("stlspec/GridWorld-v0", None, ["".join(row) for row in rows])


def bundle_of(item):
    goals = ["d_goal_1", "d_goal_2"] if len(item.get("goals", [])) > 1 else ["d_goal"]
    reach = " and ".join(f"eventually ({g} < 1)" for g in goals)
    fast = " and ".join(f"eventually[0, T] ({g} < 1)" for g in goals)
    signals = "\n".join(f"signal {name}" for name in ["d_obs", *goals])
    text = f"{signals}\nparam T\nhard phi1: always (d_obs >= 1)\nsoft phi2 depends on phi1: {reach}\n"
    return api.compile(f"{text}soft phi3_bounded_F depends on phi1, phi2: {fast}", params={"T": item["t_goal_bfs"]})


def test_all_public_demonstrations_are_looked_at():
    assert len(CASES) == sum(len(item["demos"]) for item in ITEMS if item["kind"] != "mountain-car") == 43


@pytest.mark.parametrize(("item", "demo"), CASES)
def test_label_and_robustness_are_the_expected_ones(item, demo):
    demonstration = make_demonstration("d", states=demo["states"])
    (row,) = score(bundle_of(item), [demonstration], world_of(item)).demonstrations
    assert row.label == demo["label_expected"]
    got = {name: found.result.robustness for name, found in row.requirements.items()}
    assert got == pytest.approx(demo["robustness_expected"], abs=1e-9)
