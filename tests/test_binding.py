"""What a spec reads from a demonstration."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.binding import bind, columns_of
from stlspec.compiler.bundle import BundleData, Signal, TimeBase
from stlspec.compiler.ir import Builder
from stlspec.demos import Demonstration, make_demonstration
from stlspec.envs.catalogue import make_environment
from stlspec.envs.model import derive_actions
from stlspec.errors import InputError
from stlspec.readers.model import Recording

PUBLIC = json.loads((Path(__file__).parent / "learning" / "public.json").read_text())["items"]


GRID = make_environment("stlspec/GridWorld-v0", {}, ("S.#", "..G"))


def spec(*signals: Signal | str, unused: tuple[Signal, ...] = ()) -> BundleData:
    """A compiled spec whose formulas use these signals."""
    declared = tuple(Signal(s) if isinstance(s, str) else s for s in signals)
    builder = Builder()
    for signal in declared:
        builder.add("bool" if signal.type == "bool" else "signal", value=signal.name)
    return BundleData(
        name="test",
        title=None,
        time=TimeBase("step", "step", 1),
        signals=(*declared, *unused),
        params=(),
        requirements=(),
        nodes=tuple(builder.nodes),
        names=MappingProxyType({}),
        raw_weights=(),
        weights=(),
        sources=(),
    )


def values(bound) -> dict[str, list]:
    return {name: array.tolist() for name, array in bound.signals.items()}


def refused(call, *arguments, **options):
    with pytest.raises(InputError) as error:
        call(*arguments, **options)
    return error.value.diagnostics


def test_only_the_signals_that_formulas_use_are_collected():
    demonstration = make_demonstration("d", {"y": [1, 2], "x": [3, 4], "z": [5, 6]}, time=[0, 2])
    bound = bind(spec("x", "y", unused=(Signal("missing"),)), demonstration)
    assert values(bound) == {"x": [3, 4], "y": [1, 2]}
    assert bound.time.tolist() == [0, 2]
    assert (bound.name, bound.states, bound.actions, bound.environment) == ("d", None, None, None)


def test_a_signal_is_read_from_the_column_it_names():
    demonstration = make_demonstration("d", {"speed (m/s)": [1, 2], "x": [3, 4]})
    assert values(bind(spec(Signal("x", source="speed (m/s)")), demonstration)) == {"x": [1, 2]}


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("obs.p[1]", [2, 4]),
        ("obs.v", [0.5, 1.5]),
        ("obs.ok", [True, False]),
        ("action[0]", [7, 7]),
        ("action[1]", [8, 8]),
    ],
)
def test_a_path_leads_into_states_and_actions(path, expected):
    states = [{"p": [1, 2], "v": 0.5, "ok": True}, {"p": np.array([3, 4]), "v": np.float32(1.5), "ok": False}]
    demonstration = make_demonstration("d", states=states, actions=[[7, 8]])
    assert values(bind(spec(Signal("x", source=path)), demonstration)) == {"x": expected}


def test_the_first_sample_takes_the_first_action():
    demonstration = make_demonstration("d", states=[0, 1, 2], actions=[5, 6])
    assert values(bind(spec(Signal("u", source="action")), demonstration)) == {"u": [5, 5, 6]}


def test_a_column_wins_over_a_path_of_the_same_name():
    demonstration = make_demonstration("d", {"obs[0]": [7, 8]}, states=[[1], [2]])
    assert values(bind(spec(Signal("x", source="obs[0]")), demonstration)) == {"x": [7, 8]}


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("obs[2]", "sample 1 there is no [2] in [3]"),
        ("obs.key", "sample 0 there is no .key in [1, 2, 3]"),
        ("obs", "sample 0 there is [1, 2, 3], which is no number"),
        ("obs[0][0]", "sample 0 there is no [0] in 1"),
    ],
)
def test_a_path_that_leads_nowhere_is_refused_with_its_sample(path, words):
    demonstration = make_demonstration("d", states=[[1, 2, 3], [3]])
    (found,) = refused(bind, spec(Signal("x", source=path)), demonstration)
    assert found.code == "D841" and words in found.message and found.file == "d"


def test_the_environment_computes_what_is_missing():
    demonstration = make_demonstration("d", {"d_obs": [50, 60]}, states=[[0, 0], [0, 1]])
    bound = bind(spec("d_obs", "d_goal", Signal("far", source="d_goal_1")), demonstration, GRID)
    # What was recorded stays, even where the environment could compute it.
    assert values(bound) == {"d_obs": [50, 60], "d_goal": [3, 2], "far": [3, 2]}
    assert bound.states == (0, 1) and bound.actions == (2,) and bound.environment is GRID


def test_the_demonstrations_own_environment_comes_first():
    own = {"id": "stlspec/GridWorld-v0", "map": ["SG"]}
    bound = bind(spec("d_goal"), make_demonstration("d", states=[0, 1], env=own), GRID)
    assert values(bound) == {"d_goal": [1, 0]}
    assert bound.environment.map == ("SG",)


def test_the_given_environment_computes_what_the_own_one_does_not_offer():
    own = {"id": "stlspec/GridWorld-v0", "map": ["S.", ".."]}
    other = make_environment("stlspec/GridWorld-v0", {}, ("S.a", "..."))
    bound = bind(spec("col", "d_a"), make_demonstration("d", states=[[0, 1], [1, 1]], env=own), other)
    assert values(bound) == {"col": [1, 1], "d_a": [1, 2]}
    assert bound.states == (1, 3)


def test_an_own_environment_that_is_unknown_matters_only_if_it_is_needed():
    demonstration = make_demonstration("d", {"x": [1, 2]}, states=["a", "b"], env={"id": "Nowhere-v0"})
    bound = bind(spec("x"), demonstration)
    assert values(bound) == {"x": [1, 2]} and bound.states == ("a", "b") and bound.environment is None
    (found,) = refused(bind, spec("x", "y"), demonstration)
    assert found.code == "D820" and found.file == "d"


def test_raw_observations_give_the_signals_of_the_mountain_car():
    car = make_environment("MountainCar-v0")
    demonstration = make_demonstration("d", states=[[-0.5, 0], [-0.4, 0.01]], actions=[2])
    bound = bind(spec("position", Signal("v", source="obs[1]")), demonstration, car)
    assert values(bound) == {"position": [-0.5, -0.4], "v": [0, 0.01]}
    assert bound.states == ([-0.5, 0], [-0.4, 0.01]) and bound.actions == (2,)


def test_columns_that_make_up_the_state_stand_for_states():
    bound = bind(spec("d_goal"), make_demonstration("d", {"row": [0, 0, 1], "col": [0, 1, 1]}), GRID)
    assert values(bound) == {"d_goal": [3, 2, 1]}
    assert bound.states == (0, 1, 4) and bound.actions == (2, 1)


def test_a_state_off_the_map_is_refused():
    (found,) = refused(bind, spec("d_goal"), make_demonstration("d", states=[[0, 0], [5, 5]]), GRID)
    assert found.code == "D827" and "sample 1" in found.message and found.file == "d"


@pytest.mark.parametrize(
    ("demonstration", "environment", "words"),
    [
        (make_demonstration("d", {"d_gaol": [1]}), None, ["did you mean 'd_gaol'", 'from "d_gaol"', "no states"]),
        (make_demonstration("d", states=[0]), None, ["the data has no columns", "--env"]),
        (make_demonstration("d", states=[[0, 0]]), make_environment("CartPole-v1"), ["'CartPole-v1' offers no"]),
        (make_demonstration("d", states=[[0, 0]]), make_environment("MountainCar-v0"), ["'position', 'velocity'"]),
    ],
)
def test_a_missing_signal_is_refused_with_what_there_is(demonstration, environment, words):
    (found,) = refused(bind, spec("d_goal"), demonstration, environment)
    assert found.code == "D804" and "'d_goal'" in found.message
    assert all(each in found.help for each in words)


@pytest.mark.parametrize(
    ("unit", "column", "said"),
    [
        ("m/s", "vz [ft/s]", "its name says ft/s, and `vz` is declared in m/s"),
        ("m/s**2", "vz [m/s^2]", None),
        ("percent", "vz [%]", None),
        ("m", "VZ", None),
        (None, "vz [m]", None),
    ],
)
def test_a_unit_in_the_name_of_a_column_is_compared_with_the_declared_one(unit, column, said):
    (found,) = refused(bind, spec(Signal("vz", unit=unit)), make_demonstration("d", {column: [1]}))
    assert f"did you mean '{column}'" in found.help
    assert said in found.help if said else "declared in" not in found.help


def test_all_missing_signals_are_named():
    problems = refused(bind, spec("x", Signal("v", source="info.speed")), make_demonstration("d", {"z": [1]}))
    assert [d.code for d in problems] == ["D804", "D804"]
    assert "a recording has no info" in problems[1].help


def test_without_a_step_there_is_no_action_to_read():
    (found,) = refused(bind, spec(Signal("u", source="action")), make_demonstration("d", states=[0], actions=[]))
    assert found.code == "D804"


def test_actions_are_derived_from_states():
    # Left from column 0 is the border: left and down both stay in the corner, and the lowest wins.
    states = [[0, 0], [0, 1], [1, 1], [1, 0], [1, 0], [0, 2]]
    assert derive_actions(GRID, GRID.encode_all(states)) == (2, 1, 0, 0, None)
    assert derive_actions(GRID, [3]) == ()
    assert derive_actions(make_environment("FrozenLake-v1"), [0, 1]) is None


@given(st.lists(st.integers(0, 3), max_size=20))
def test_derived_actions_lead_along_the_same_states(actions):
    states = [0]
    for action in actions:
        states.append(GRID.transitions[states[-1]][action])
    derived = derive_actions(GRID, states)
    assert [GRID.transitions[s][a] for s, a in zip(states, derived, strict=False)] == states[1:]


def test_a_signal_can_be_read_from_derived_actions():
    demonstration = make_demonstration("d", states=[[0, 0], [0, 1], [1, 1]])
    assert values(bind(spec(Signal("u", source="action")), demonstration, GRID)) == {"u": [2, 2, 1]}


def test_recorded_actions_are_kept():
    bound = bind(spec("row"), make_demonstration("d", states=[0, 0], actions=[3]), GRID)
    assert bound.actions == (3,)


HOLES = make_demonstration(
    "d",
    {"x": [1, math.nan, 3, math.nan], "y": [5, 6, 7, 8], "ok": [True, False, None, True], "unused": [math.nan] * 4},
    time=[0, 1, 2, 3],
    states=[0, 1, 4, 5],
)


def test_nan_is_left_for_the_evaluation_to_refuse():
    assert math.isnan(bind(spec("x"), HOLES).signals["x"][1])


def test_hold_repeats_the_previous_value():
    demonstration = make_demonstration(
        "d", {"x": [math.nan, 1, math.nan, math.nan, 2], "ok": [True, *[math.nan] * 3, False]}
    )
    bound = bind(spec("x", Signal("ok", type="bool")), demonstration, on_nan="hold")
    np.testing.assert_array_equal(bound.signals["x"], [math.nan, 1, 1, 1, 2])
    assert bound.signals["ok"].tolist() == [True, True, True, True, False] and bound.signals["ok"].dtype == bool


def test_drop_leaves_out_the_sample_everywhere():
    bound = bind(spec("x", "y"), HOLES, GRID, on_nan="drop")
    assert values(bound) == {"x": [1, 3], "y": [5, 7]}
    assert bound.time.tolist() == [0, 2] and bound.states == (0, 4)
    # No single move leads from cell 0 to cell 4.
    assert bound.actions == (None,)


def test_drop_keeps_the_actions_that_lead_to_kept_samples():
    demonstration = make_demonstration("d", {"x": [1, math.nan, 3]}, actions=[7, 8])
    assert bind(spec("x"), demonstration, on_nan="drop").actions == (8,)


def test_drop_also_looks_at_the_columns_that_make_up_the_state():
    demonstration = make_demonstration("d", {"row": [0, math.nan, 1], "col": [0, 1, 1]})
    assert values(bind(spec("d_goal"), demonstration, GRID, on_nan="drop")) == {"d_goal": [3, 1]}


def test_something_has_to_be_left():
    (found,) = refused(bind, spec("x"), make_demonstration("d", {"x": [math.nan]}), on_nan="drop")
    assert found.code == "D803"


def test_other_columns_do_not_matter():
    assert values(bind(spec("y"), HOLES, on_nan="drop")) == {"y": [5, 6, 7, 8]}


def test_binding_changes_nothing():
    before = {name: column.copy() for name, column in HOLES.recording.columns.items()}
    for on_nan in ("refuse", "hold", "drop"):
        bind(spec("x", "y"), HOLES, GRID, on_nan=on_nan)
    for name, column in before.items():
        assert repr(HOLES.recording.columns[name]) == repr(column)


def test_scoring_recorded_signals_needs_no_gymnasium():
    program = "import stlspec.binding, sys; print('gymnasium' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout == "False\n"


def test_the_public_mountain_car_demonstrations_are_raw_observations():
    (item,) = [item for item in PUBLIC if item["kind"] == "mountain-car"]
    for states in item["demos"]:
        bound = bind(
            spec("position", "velocity"), make_demonstration("d", states=states), make_environment("MountainCar-v0")
        )
        assert values(bound) == {"position": [p for p, _ in states], "velocity": [v for _, v in states]}


def world_of(item):
    """The environment of an item of the public data: a grid-world, or gymnasium's stock lake."""
    if "train_map" in item:
        return make_environment("FrozenLake-v1", {"map_name": item["train_map"], "is_slippery": item["slippery"]})
    rows = [["."] * item["size"] for _ in range(item["size"])]
    marks = "G" if len(item["goals"]) == 1 else "123456789"
    cells = [("S", item["start"]), *zip(marks, item["goals"], strict=False)]
    for mark, (row, column) in [*cells, *(("#", cell) for cell in item["obstacles"])]:
        rows[row][column] = mark
    return make_environment("stlspec/GridWorld-v0", {}, ["".join(row) for row in rows])


def marked(world, letters):
    return [(r, c) for r, row in enumerate(world.map) for c, x in enumerate(row) if x in letters]


def nearest(cells, state):
    return min(abs(r - state[0]) + abs(c - state[1]) for r, c in cells)


DEMOS = [(item, number) for item in PUBLIC if item["kind"] != "mountain-car" for number in range(len(item["demos"]))]


@pytest.mark.parametrize(("item", "number"), DEMOS, ids=[f"{item['name']}-{k}" for item, k in DEMOS])
def test_the_signals_of_the_public_demonstrations_follow_the_definition(item, number):
    world, demo = world_of(item), item["demos"][number]
    goals = [tuple(goal) for goal in item.get("goals", [])] or marked(world, "G")
    obstacles = [tuple(cell) for cell in item.get("obstacles", [])] or marked(world, "H")
    expected = {
        "row": [s[0] for s in demo["states"]],
        "col": [s[1] for s in demo["states"]],
        "d_obs": [nearest(obstacles, s) for s in demo["states"]],
        "d_goal": [nearest(goals, s) for s in demo["states"]],
    }
    for k, goal in enumerate(goals, 1):
        expected[f"d_goal_{k}"] = [nearest([goal], s) for s in demo["states"]]
    bound = bind(spec(*expected), make_demonstration("d", states=demo["states"]), world)
    assert values(bound) == expected
    # always (d_obs >= 1), eventually (d_goal < 1) for each goal, and the label by its verdict of the first.
    assert min(expected["d_obs"]) - 1 == demo["robustness_expected"]["phi1"]
    reach = min(max(1 - d for d in expected[f"d_goal_{k}"]) for k in range(1, len(goals) + 1))
    assert reach == demo["robustness_expected"]["phi2"]
    assert (min(expected["d_obs"]) < 1) == (demo["label_expected"] == "bad")
    if "start" in item:
        assert world.decode(world.start) == item["start"]
    moves = zip(bound.states, bound.actions, bound.states[1:], strict=False)
    assert all(world.transitions[s][a] == after for s, a, after in moves if a is not None)


def test_an_unknown_treatment_of_nan_is_refused():
    demonstration = make_demonstration("d", {"x": [1, math.nan]})
    for word in ("Refuse", "zero", None):
        (found,) = refused(bind, spec("x"), demonstration, on_nan=word)
        assert found.code == "D880"
    assert "'refuse'" in refused(bind, spec("x"), demonstration, on_nan="Refuse")[0].help


def test_states_of_an_environment_that_cannot_be_made_are_not_taken_for_those_of_another():
    demonstration = make_demonstration("d", {"x": [1, 2]}, states=[[0, 0], [0, 1]], env={"id": "Nowhere-v0"})
    bound = bind(spec("x"), demonstration, GRID)
    assert values(bound) == {"x": [1, 2]}
    assert bound.environment is None and bound.actions is None and bound.states == ([0, 0], [0, 1])
    (found,) = refused(bind, spec("d_goal"), demonstration, GRID)
    assert found.code == "D820"


def test_a_masked_value_is_a_hole():
    demonstration = make_demonstration("d", {"x": np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0])})
    assert values(bind(spec("x"), demonstration, on_nan="hold")) == {"x": [1, 1, 3]}


def test_a_missing_signal_is_looked_for_among_the_columns_that_were_not_read():
    demonstration = Demonstration("d", Recording(columns={"y": np.array([1.0])}, others=("speeed",)), "d.parquet")
    (found,) = refused(bind, spec("speed"), demonstration)
    assert "speeed" in found.help


def test_samples_are_taken_again_before_states_are_counted():
    base = TimeBase("stamps", "s", 10**9)
    demonstration = make_demonstration("d", {"x": [1, 2, 3]}, time=[0, 0.3, 1.0], states=[0, 1, 4])
    bound = bind(replace(spec("x"), time=base), demonstration, GRID, resample=500_000_000)
    assert values(bound) == {"x": [1, 2, 3]}
    assert (bound.time.tolist(), bound.states, bound.actions) == ([0, 0.5, 1], (0, 1, 4), (2, 1))


def test_only_what_may_be_read_is_asked_for():
    used = spec("x", Signal("v", source="speed"), unused=(Signal("z"),))
    assert columns_of(used) == {"x", "speed"}
    assert columns_of(used, make_environment("MountainCar-v0")) == {"x", "speed", "position", "velocity"}


@pytest.mark.parametrize(
    ("states", "actions", "parts"),
    [
        ([[0, 0], [0, 2], [0, 0]], None, ("sample 0 to 1 is no step of", "(the first of 2)", "record every step")),
        ([[0, 0], [1, 0]], [2], ("action 2 does not lead from [0, 0] to [1, 0]", "correct 'actions'")),
        ([[0, 0], [1, 0]], [1], ()),
        ([[0, 0], [1, 0]], None, ()),
    ],
)
def test_a_step_that_the_environment_cannot_take_is_doubted_not_refused(states, actions, parts):
    bound = bind(spec("d_obs"), make_demonstration("d", states=states, actions=actions), GRID)
    assert [(w.code, w.severity) for w in bound.warnings] == [("D859", "warning")] * bool(parts)
    assert all(part in f"{bound.warnings[0].message} {bound.warnings[0].help}" for part in parts)


def test_nothing_is_doubted_without_states_or_an_environment():
    assert bind(spec("x"), make_demonstration("d", {"x": [1.0, 2.0]})).warnings == ()
    assert bind(spec("x"), make_demonstration("d", {"x": [1.0, 2.0]}, states=[[0, 0], [0, 2]])).warnings == ()
