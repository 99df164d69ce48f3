"""Algorithm 1: every rule by hand, the public maps by the definition, and files that were tampered with."""

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec import api, rewards
from stlspec.demos import make_demonstration
from stlspec.envs.bins import Bins
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import Environment
from stlspec.errors import DataError
from stlspec.rewards import (
    RewardMap,
    demonstration_values,
    infer_reward,
    learner_reward,
    load_reward,
    penalty,
    ranked_states,
    rising_values,
)

SPEC = """
signal d_obs
signal d_goal
param T_goal
hard avoid: always (d_obs >= 1)
soft reach depends on avoid: eventually (d_goal < 1)
soft fast depends on avoid, reach: eventually[0, T_goal] (d_goal < 1)
"""
WORLD = make_environment("stlspec/GridWorld-v0", None, ("S.G", ".#."))
BUNDLE = api.compile(SPEC, params={"T_goal": 2})
GOOD = make_demonstration("good", states=[[0, 0], [0, 1], [0, 2]])
BAD = make_demonstration("bad", states=[[0, 0], [1, 0], [1, 1], [1, 2], [0, 2]])


def code(caught):
    return caught.value.diagnostics[0].code


def test_values_rise_along_a_demonstration():
    assert rising_values(0.6, 3) == pytest.approx([0.2, 0.4, 0.6])
    assert rising_values(0.5, 1) == [0.5]


@pytest.mark.parametrize(
    ("weights", "bounded", "expected"),
    [([0.5], [-0.5], -0.25), ([0.5], [0.0], -0.005), ([0.5, 0.25], [-0.5, -1.0], -0.5), ([], [], 0.0)],
)
def test_the_penalty_is_negative_by_construction(weights, bounded, expected):
    assert penalty(weights, bounded) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("label", "reward", "expected"),
    [
        ("good", 0.8, {7: 0.6, 5: 0.4, 9: 0.8}),
        ("incomplete", 0.8, {7: 0.6, 5: 0.4, 9: 0.8}),
        ("incomplete", -0.8, {7: 0.0, 5: 0.0, 9: 0.0}),
        ("bad", 0.8, {5: -0.25, 9: -0.25}),
    ],
)
def test_what_states_get_follows_from_the_label(label, reward, expected):
    """Four samples, the first and the third in state 7, which keeps the larger value."""
    found = demonstration_values((7, 5, 7, 9), label, reward, [1, 3], -0.25)
    assert found == pytest.approx(expected)


def test_the_learner_reward_is_the_ranked_sum_over_its_largest_value():
    """1 * -0.5 + 2 * 0.1 = -0.3 and 2 * 0.3 = 0.6, divided by 0.6; a sum of 0 is left out."""
    found = learner_reward([1, 2], [{4: -0.5, 8: -0.4}, {4: 0.1, 6: 0.3, 8: 0.2}])
    assert found == pytest.approx({4: -0.5, 6: 1.0})
    assert list(found) == [4, 6]
    assert learner_reward([], []) == {}
    assert learner_reward([1], [{3: 0.0}]) == {}


VALUES = st.dictionaries(st.integers(0, 5), st.floats(-1, 1, allow_subnormal=False), max_size=5)


@given(st.lists(st.tuples(st.integers(1, 4), VALUES), max_size=4))
def test_the_learner_reward_is_normalised_and_does_not_depend_on_order(rows):
    found = learner_reward([r for r, _ in rows], [v for _, v in rows])
    again = learner_reward([r for r, _ in rows[::-1]], [v for _, v in rows[::-1]])
    assert found == again
    if found:
        assert max(map(abs, found.values())) == 1.0
    assert all(found.values())


def test_a_map_by_hand():
    """S.G / .#.: good has rho (0, 1, 1), bad (-1, 1, -1) and violates in (1, 1); ranks 2 and 1."""
    w = [math.exp(k) / sum(map(math.exp, (3, 2, 1))) for k in (3, 2, 1)]
    t = math.tanh(1)
    r_good, penalised = t * (w[1] + w[2]), -t * w[0]
    total = {(0, 0): 2 * r_good / 3, (0, 1): 4 * r_good / 3, (0, 2): 2 * r_good, (1, 1): penalised}
    largest = max(map(abs, total.values()))
    reward = infer_reward(BUNDLE, [BAD, GOOD], WORLD)
    assert dict(zip(reward.states, reward.values, strict=True)) == pytest.approx(
        {state: value / largest for state, value in total.items()}
    )
    assert reward.meaning_sha256 == BUNDLE.meaning_sha256
    assert not reward.all_zero
    assert reward.warnings() == ()
    table = reward.table(WORLD)
    assert table[3] == table[5] == 0.0
    assert table[4] == pytest.approx(penalised / largest)


def items():
    place = Path(__file__).parent / "learning" / "public.json"
    return [x for x in json.loads(place.read_text())["items"] if x["kind"] == "grid-single"]


def naive_reward(item):
    """Algorithm 1 written out once more, over the robustness that public.json states."""
    w = [math.exp(k) / sum(map(math.exp, (3, 2, 1))) for k in (3, 2, 1)]
    obstacles = {tuple(o) for o in item["obstacles"]}
    rows = []
    for demo in item["demos"]:
        rho = [math.tanh(demo["robustness_expected"][k]) for k in ("phi1", "phi2", "phi3_bounded_F")]
        rows.append((demo, sum(a * b for a, b in zip(w, rho, strict=True)), rho[0]))
    order = sorted({(["bad", "incomplete", "good"].index(d["label_expected"]), round(r, 9)) for d, r, _ in rows})
    total = {}
    for demo, r, rho1 in rows:
        label = demo["label_expected"]
        rank = order.index((["bad", "incomplete", "good"].index(label), round(r, 9))) + 1
        states = [tuple(s) for s in demo["states"]]
        given = {}
        for k, state in enumerate(states, 1):
            if label == "bad":
                value = -w[0] * max(abs(rho1), 0.01) if state in obstacles else None
            else:
                value = k / len(states) * (r if label == "good" else max(r, 0.0))
            if value is not None:
                given[state] = max(value, given.get(state, -9.0))
        for state, value in given.items():
            total[state] = total.get(state, 0.0) + rank * value
    largest = max(map(abs, total.values()))
    return {state: value / largest for state, value in total.items() if value}


@pytest.mark.parametrize("item", items(), ids=lambda item: item["name"])
def test_the_public_maps_come_out_as_the_definition_says(item):
    rows = [["."] * item["size"] for _ in range(item["size"])]
    for (row, column), mark in [(item["start"], "S"), (item["goals"][0], "G")]:
        rows[row][column] = mark
    for row, column in item["obstacles"]:
        rows[row][column] = "#"
    world = make_environment("stlspec/GridWorld-v0", None, ["".join(row) for row in rows])
    bundle = api.compile(SPEC, params={"T_goal": item["t_goal_bfs"]})
    demos = [make_demonstration(f"d{k}", states=d["states"]) for k, d in enumerate(item["demos"])]
    labels = [d.label for d in ranked_states(bundle, demos, world)]
    assert labels == [d["label_expected"] for d in item["demos"]]
    reward = infer_reward(bundle, demos, world)
    assert dict(zip(reward.states, reward.values, strict=True)) == pytest.approx(naive_reward(item))


@pytest.mark.parametrize(
    ("hard", "samples"),
    [
        ("always (x >= 1)", [1, 3]),
        ("always (x > 1)", [0, 1, 3]),
        ("always[0, 2] (x >= 1)", [1]),
        ("always[2, 3] (x >= 1)", [3]),
        ("always (x >= 1 or next (x >= 1))", [3]),
        ("eventually (x > 9)", [2]),
        ("(x >= 1) until (x > 9)", [2]),
    ],
)
def test_violating_states_are_those_where_psi_is_false_or_else_the_witness(hard, samples):
    """x is 1, 0, 5, -1; `next` past the end is false, so the last sample violates `psi or next psi`."""
    bundle = api.compile(f"signal x\nhard a: {hard}")
    demo = make_demonstration("d", {"x": [1, 0, 5, -1]}, states=[[0, 0], [0, 1], [0, 2], [1, 2]])
    cells = [[0, 0], [0, 1], [0, 2], [1, 2]]
    reward = infer_reward(bundle, [demo], WORLD)
    assert sorted(reward.states) == sorted(tuple(cells[k]) for k in samples)
    assert set(reward.values) == {-1.0}


def test_a_demonstration_names_its_own_environment():
    own = make_demonstration("own", states=[[0, 0], [0, 1], [0, 2]], env=WORLD.describe())
    assert infer_reward(BUNDLE, [own]) == infer_reward(BUNDLE, [GOOD], WORLD)


def test_a_reward_of_0_everywhere_is_a_warning():
    lost = make_demonstration("lost", states=[[0, 1], [0, 1]])
    for reward in (infer_reward(BUNDLE, [lost], WORLD), infer_reward(BUNDLE, [], WORLD), infer_reward(BUNDLE, [])):
        assert reward.all_zero
        assert [w.code for w in reward.warnings()] == ["D864"]
        assert not any(reward.table(WORLD))


def test_a_demonstration_without_states_is_refused():
    with pytest.raises(DataError) as caught:
        infer_reward(BUNDLE, [make_demonstration("d", {"d_obs": [1.0], "d_goal": [0.0]})], WORLD)
    assert code(caught) == "D861"


def test_states_without_an_environment_are_refused():
    with pytest.raises(DataError) as caught:
        infer_reward(BUNDLE, [make_demonstration("d", {"d_obs": [1.0], "d_goal": [0.0]}, states=[[0, 0]])])
    assert code(caught) == "D875"


def test_demonstrations_of_different_sizes_are_refused():
    wide = make_environment("stlspec/GridWorld-v0", None, ("S..G",))
    other = make_demonstration("other", states=[0, 1, 2, 3], env=wide.describe())
    with pytest.raises(DataError) as caught:
        infer_reward(BUNDLE, [GOOD, other], WORLD)
    assert code(caught) == "D862"
    assert "'other'" in str(caught.value)


def test_a_map_carries_over_to_a_map_of_the_same_size_and_to_no_smaller_one():
    reward = infer_reward(BUNDLE, [GOOD], WORLD)
    assert reward.table(make_environment("stlspec/GridWorld-v0", None, ("S..", "..G")))[2] == 1.0
    with pytest.raises(DataError) as caught:
        reward.table(make_environment("stlspec/GridWorld-v0", None, ("S.", ".G")))
    assert code(caught) == "D862"


CAR_BINS = Bins((-1.2, -0.07), (0.6, 0.07), (20, 20))


@pytest.mark.parametrize(
    ("bins", "parts"),
    [
        (
            Bins((-1.2, -0.07), (0.6, 0.07), (25, 16)),
            ("bins 20,20,", "is cut into 25,16 here", "--bins 20,20; or infer"),
        ),
        (
            Bins((-1.2, -0.07), (0.6, 0.07), (10, 10)),
            ("bins 20,20,", "is cut into 10,10 here", "--bins 20,20; or infer"),
        ),
        (Bins((-1.2, -0.07), (0.6, 0.08), (20, 20)), ("20,20 of [-1.2, 0.6] x [-0.07, 0.07]", "x [-0.07, 0.08]")),
        (None, ("numbers its states itself",)),
    ],
)
def test_a_map_over_bins_is_refused_where_the_bins_are_others(bins, parts):
    """25,16 has as many bins as 20,20: without the refusal every value would land on some other bin."""
    home = {"id": "MountainCar-v0", "args": {}, "map": None, "bins": CAR_BINS.to_json()}
    reward = RewardMap("", home, (210,), (1.0,))
    with pytest.raises(DataError) as caught:
        reward.table(Environment("MountainCar-v0", n_states=0 if bins else 400, bins=bins))
    assert code(caught) == "D858"
    assert all(part in str(caught.value) for part in parts)
    assert reward.table(Environment("MountainCar-v0", bins=CAR_BINS))[210] == 1.0


def test_damaged_bins_of_a_map_are_refused():
    reward = RewardMap("", {"id": "MountainCar-v0", "bins": {"low": "?"}}, (1,), (1.0,))
    with pytest.raises(DataError) as caught:
        reward.table(Environment("MountainCar-v0", bins=CAR_BINS))
    assert code(caught) == "D863"


REWARD = infer_reward(BUNDLE, [GOOD, BAD], WORLD)


def test_a_reward_map_comes_back_from_its_file(tmp_path):
    place = tmp_path / "r.json"
    place.write_text(json.dumps(REWARD.to_json()))
    assert load_reward(place) == REWARD
    document = REWARD.to_json()
    assert list(document) == ["schema", "meaning_sha256", "env", "states", "values"]
    assert document["env"] == {"id": "stlspec/GridWorld-v0", "args": {}, "map": ["S.G", ".#."]}


@pytest.mark.parametrize(
    "change",
    [
        {"schema": "stlspec.score/1"},
        {"meaning_sha256": 3},
        {"env": []},
        {"states": [[0, 0]]},
        {"values": None},
        {"states": [[0, 0]] * 4},
        {"states": [[0, 0], [0, 1], [0, 2], [0, -1]]},
        {"states": [[0, 0], [0, 1], [0, 2], "a"]},
        {"values": [0, 0, 0, 1.5]},
        {"values": [0, 0, 0, math.nan]},
        {"values": [0, 0, 0, True]},
        {"values": [0, 0, 0, "inf"]},
        {"values": [0, 0, 0, 10**400]},
    ],
)
def test_a_damaged_reward_map_is_refused(tmp_path, change):
    place = tmp_path / "r.json"
    place.write_text(json.dumps({**REWARD.to_json(), **change}))
    with pytest.raises(DataError) as caught:
        load_reward(place)
    assert code(caught) == "D863"
    assert caught.value.diagnostics[0].file == str(place)


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", b"[]", b"[" * 100_000])
def test_what_is_no_reward_map_at_all_is_refused(tmp_path, content):
    place = tmp_path / "r.json"
    place.write_bytes(content)
    with pytest.raises(DataError) as caught:
        load_reward(place)
    assert code(caught) == "D863"
    with pytest.raises(DataError):
        load_reward(tmp_path)


def test_an_endless_file_is_refused(monkeypatch):
    monkeypatch.setattr(rewards, "_LARGEST_FILE", 1000)
    with pytest.raises(DataError) as caught:
        load_reward("/dev/zero")
    assert code(caught) == "D863"
    assert "larger" in str(caught.value)


def test_a_reward_on_a_map_shows_itself_in_a_notebook() -> None:
    described = {"id": "stlspec/GridWorld-v0", "args": {}, "map": ["S.", ".G"]}
    reward = RewardMap("0" * 64, described, ((0, 1), (1, 1)), (0.5, 1.0))
    assert reward.board(path=((0, 0), (0, 1))).path == (0, 1)
    assert reward.board().values == {1: 0.5, 3: 1.0}
    assert reward._repr_svg_().count("0.50") >= 1


@pytest.mark.parametrize("rows", [None, [], ["S", "S."], [""], ["S"]])
def test_a_reward_without_a_sensible_map_has_no_picture(rows: list | None) -> None:
    assert RewardMap("0" * 64, {"id": "x", "args": {}, "map": rows}, ((0, 1),), (0.5,))._repr_svg_() is None
