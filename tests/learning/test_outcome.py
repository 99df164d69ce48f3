"""The outcome as a document."""

import json
from dataclasses import replace

import pytest

from stlspec.learning import learn
from stlspec.learning.outcome import Log, meets
from stlspec.learning.shaping import GOAL, VIOLATION
from stlspec.semantics.evaluation import evaluate


@pytest.fixture(scope="module")
def outcome(small):
    bundle, world, demos = small
    return learn(bundle, world, demos, episodes=300)


def test_the_document_has_the_agreed_keys(outcome):
    document = json.loads(json.dumps(outcome.to_json(), allow_nan=False))
    assert list(document) == [
        "schema", "method", "seed", "success", "policy", "requirements", "satisfaction_probability",
        "training", "files",
    ]  # fmt: skip
    assert document["schema"] == "stlspec.learn/1"
    assert set(document["training"]) == {
        "episodes", "env_steps", "env_steps_to_success", "episodes_to_success", "hard_violations", "seconds",
    }  # fmt: skip
    path = document["policy"]["states"]
    assert path[0] == [4, 0]
    assert path[-1] == [0, 4]
    assert len(document["policy"]["actions"]) == len(path) - 1 == 8
    assert document["policy"]["goal_order"] == ["at_goal"]
    assert document["requirements"]["avoid"] == {"robustness": 0.0, "verdict": "satisfied"}
    assert document["satisfaction_probability"] is None


def test_actions_lead_along_the_path(outcome, small):
    world = small[1]
    for before, action, after in zip(outcome.states, outcome.actions, outcome.states[1:], strict=False):
        assert world.transitions[before][action] == after


def test_infinite_numbers_are_words(kit):
    world = kit.grid_world(("S.", ".G"))
    found = learn(kit.grid_bundle(2), world, episodes=50).to_json()
    assert found["requirements"]["avoid"]["robustness"] == "inf"


def test_the_log_has_a_line_for_each_episode():
    text = Log((3, 1), (0.97, -1.01), (GOAL, VIOLATION)).to_csv()
    assert text == "episode,steps,return,outcome\n1,3,0.97,goal\n2,1,-1.01,violation\n"


def test_an_outcome_cannot_be_changed(outcome):
    with pytest.raises(AttributeError):
        outcome.success = False
    assert replace(outcome, success=False).success is False


def test_meeting_is_a_matter_of_verdicts(small):
    """Beside an obstacle rho of avoid is 0, and it holds; reach and fast fail."""
    result = evaluate(small[0], {"d_obs": [1.0], "d_goal": [2.0]})
    assert meets(small[0], result, hard_only=True)
    assert not meets(small[0], result)


def test_the_path_shows_itself_on_the_map_in_a_notebook(outcome):
    assert 'class="stl-path"' in outcome._repr_svg_()
    elsewhere = replace(outcome.policy, environment={"id": "x", "args": {}, "map": None})
    assert replace(outcome, policy=elsewhere)._repr_svg_() is None
