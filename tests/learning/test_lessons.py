"""What each demonstration taught, and where the reward of a state comes from."""

import json

import pytest

from stlspec import api
from stlspec.envs.catalogue import make_environment
from stlspec.errors import DataError
from stlspec.learning import learn
from stlspec.learning.lessons import explain, source_of


@pytest.fixture(scope="module")
def run(kit, tmp_path_factory):
    """By hand on S.G / .#.: one way right, one way with a rest, one into the obstacle."""
    out = tmp_path_factory.mktemp("run") / "out"
    paths = [[[0, 0], [0, 1], [0, 2]], [[0, 0], [0, 0], [0, 1], [0, 2]], [[0, 0], [1, 0], [1, 1], [0, 1], [0, 2]]]
    outcome = learn(kit.grid_bundle(2), kit.grid_world(("S.G", ".#.")), kit.demonstrations(paths), episodes=50, out=out)
    return outcome, out


def test_each_demonstration_s_part_is_told(run):
    outcome, _ = run
    good, late, bad = outcome.lessons.lessons
    assert [(x.label, x.rank, x.length) for x in (good, late, bad)] == [
        ("good", 3, 3),
        ("incomplete", 2, 4),
        ("bad", 1, 5),
    ]
    assert [(state, sample) for state, _, sample in good.values] == [((0, 0), 0), ((0, 1), 1), ((0, 2), 2)]
    assert [value / good.values[-1][1] for _, value, _ in good.values] == pytest.approx([1 / 3, 2 / 3, 1])
    assert (good.forbids, good.broken) == ((), ())
    assert [(f.state, f.action, f.after) for f in bad.forbids] == [((1, 0), "right", (1, 1))]
    assert bad.broken == ("avoid",)
    assert [state for state, _, _ in bad.values] == [(1, 1)]


@pytest.mark.parametrize("state", [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)])
def test_the_terms_add_up_to_the_reward(run, kit, state):
    outcome, out = run
    found = explain(out, state)
    reward = outcome.reward.table(kit.grid_world(("S.G", ".#.")))[3 * state[0] + state[1]]
    assert found.reward == reward
    assert sum(lesson.rank * value for lesson, value, _ in found.terms) / found.divisor == pytest.approx(reward)
    assert found == source_of(outcome.lessons, reward, state)
    assert bool(found.forbidden) == (state == (1, 0))


def test_a_number_is_taken_for_a_cell_too(run):
    _, out = run
    assert explain(out, 4) == explain(out, (1, 1))


def test_the_document_names_demonstrations_and_samples(run):
    _, out = run
    document = json.loads(json.dumps(explain(out, (1, 0)).to_json(), allow_nan=False))
    assert document["forbidden"] == [{"demonstration": "d2", "action": "right", "to": [1, 1]}]
    assert document["terms"] == []
    assert explain(out, (0, 1)).to_json()["terms"][0]["sample"] == 1


def test_a_given_reward_has_no_demonstrations(run, kit, tmp_path):
    outcome, _ = run
    again = learn(
        kit.grid_bundle(2), kit.grid_world(("S.G", ".#.")), reward=outcome.reward, episodes=25, out=tmp_path / "o"
    )
    assert again.lessons.given
    assert explain(tmp_path / "o", (0, 1)).given
    assert explain(tmp_path / "o", (0, 1)).reward == pytest.approx(outcome.reward.values[1])


def test_memory_is_told(kit):
    bundle = api.compile(
        "signal in_w: bool\nsignal in_d: bool\nsignal d_goal\n"
        "hard drip: always (once[0, 2] in_w implies not in_d)\nsoft home: eventually (d_goal < 1)"
    )
    (path,) = kit.demonstrations([[[0, 0], [0, 1], [0, 2], [0, 3], [0, 4]]])
    found = learn(bundle, kit.grid_world(("Swd.G", ".....")), [path], episodes=50).lessons
    assert found.memory
    assert [(f.state, f.action) for f in found.lessons[0].forbids] == [((0, 1), "right")]


@pytest.mark.parametrize("state", [(9, 9), (0, 3), 6, 99])
def test_a_state_that_the_run_does_not_have_is_refused(run, state):
    with pytest.raises(DataError) as caught:
        explain(run[1], state)
    assert caught.value.diagnostics[0].code == "D874"


@pytest.mark.parametrize("file", ["lessons.json", "policy.json", "reward.json"])
@pytest.mark.parametrize("text", [None, "{", "[]", '{"schema": "stlspec.lessons/1"}', '{"schema": "stlspec.reward/1"}'])
def test_a_run_that_is_none_is_refused(run, tmp_path, file, text):
    for name in ("lessons.json", "policy.json", "reward.json"):
        (tmp_path / name).write_bytes((run[1] / name).read_bytes())
    (tmp_path / file).unlink()
    if text is not None:
        (tmp_path / file).write_text(text)
    with pytest.raises(DataError) as caught:
        explain(tmp_path, (0, 0))
    assert caught.value.diagnostics[0].code in ("D873", "D874")


def test_where_transitions_are_by_chance_nothing_is_forbidden(kit, tmp_path):
    world = make_environment("FrozenLake-v1", {"is_slippery": True}, ("SFH", "FFG"))
    demos = kit.demonstrations([[[0, 0], [1, 0], [1, 1], [1, 2]], [[0, 0], [0, 1], [0, 2]]])
    learn(kit.grid_bundle(3), world, demos, episodes=50, out=tmp_path / "o")
    found = explain(tmp_path / "o", (1, 1))
    assert [lesson.label for lesson, _, _ in found.terms] == ["good"]
    assert sum(lesson.rank * value for lesson, value, _ in found.terms) / found.divisor == pytest.approx(found.reward)
    assert explain(tmp_path / "o", (0, 1)).forbidden == ()
