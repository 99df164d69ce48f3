import pytest

from stlspec.envs.catalogue import make_environment
from stlspec.envs.foreign import environment, make, make_quietly
from stlspec.errors import UsageError


def test_a_registered_environment_is_described_without_being_made():
    described = environment("CartPole-v1", {"sutton_barto_reward": True}, None, [])
    assert (described.n_states, described.max_steps, described.signal_names) == (0, 500, ())
    assert described.describe() == {"id": "CartPole-v1", "args": {"sutton_barto_reward": True}, "map": None}


def test_an_unknown_id_gets_a_suggestion():
    with pytest.raises(UsageError, match="did you mean 'CartPole-v1'"):
        environment("Cartpole-v1", {}, None, [])
    with pytest.raises(UsageError, match="known are A, B"):
        environment("zzzzzzzz", {}, None, ["A", "B"])


def test_a_map_is_refused():
    with pytest.raises(UsageError, match="D821"):
        environment("CartPole-v1", {}, ["S"], [])


def test_the_live_environment_is_made_from_the_description():
    live = make(make_environment("stlspec/GridWorld-v0", {}, ["SG"]), render_mode="ansi")
    assert live.reset()[0] == 0
    assert live.render() == "@G\n"


def test_a_failure_to_make_it_is_a_diagnostic():
    with pytest.raises(UsageError, match="D843"):
        make_quietly("CartPole-v1", {"no_such_argument": 1})


def test_no_warning_of_gymnasium_leaks():
    # An outdated version makes gymnasium warn; warnings are errors in these tests.
    assert make_quietly("CartPole-v0", {}).spec.id == "CartPole-v0"
