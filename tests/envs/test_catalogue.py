import pickle
import subprocess
import sys
from importlib.metadata import EntryPoint

import gymnasium
import pytest

from stlspec.envs import catalogue
from stlspec.envs.catalogue import BUILT_IN, environment_of, make_environment, parse_env_args
from stlspec.envs.model import Environment
from stlspec.errors import InputError, UsageError


def code(error: pytest.ExceptionInfo[InputError]) -> str:
    (found,) = error.value.diagnostics
    return found.code


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_environments_need_no_package_metadata(name, monkeypatch):
    monkeypatch.setattr(catalogue, "entry_points", lambda group: pytest.fail("looked up"))
    assert make_environment(name).id == name


def test_any_other_gymnasium_environment_is_known_by_its_id():
    assert make_environment("Acrobot-v1").max_steps == 500


def test_the_same_request_gives_the_same_environment():
    first = make_environment("FrozenLake-v1", {"is_slippery": False, "map_name": "4x4"})
    assert make_environment("FrozenLake-v1", {"map_name": "4x4", "is_slippery": False}) is first


def test_an_unknown_environment_is_refused_with_a_suggestion():
    with pytest.raises(UsageError, match="did you mean 'stlspec/GridWorld-v0'") as error:
        make_environment("GridWorld-v0", file="d.json")
    assert code(error) == "D820"
    assert error.value.diagnostics[0].file == "d.json"
    assert error.value.exit_code == 2


@pytest.mark.parametrize("name", ["this:Zen-v0", "this:CartPole-v1", ":CartPole-v1"])
def test_an_id_in_data_cannot_choose_a_module_to_import(name):
    with pytest.raises(UsageError, match="does not choose what is imported") as error:
        environment_of({"id": name}, file="hostile.json")
    assert code(error) == "D829"
    assert error.value.diagnostics[0].file == "hostile.json"
    assert "this" not in sys.modules


@pytest.fixture
def module(tmp_path, monkeypatch):
    """A module that registers a corridor of its own, not imported yet."""
    monkeypatch.syspath_prepend(tmp_path)
    name = "corridor_of_my_own"
    (tmp_path / f"{name}.py").write_text(
        "import gymnasium\n"
        "class Corridor(gymnasium.Env):\n"
        "    observation_space = gymnasium.spaces.Discrete(3)\n"
        "    action_space = gymnasium.spaces.Discrete(2)\n"
        "gymnasium.register('mine/Corridor-v0', entry_point=f'{__name__}:Corridor', max_episode_steps=9)\n"
    )
    yield name
    sys.modules.pop(name, None)
    gymnasium.registry.pop("mine/Corridor-v0", None)
    catalogue._made.cache_clear()


def test_the_module_that_the_user_names_is_imported_and_makes_the_environment_known(module):
    made = make_environment(f"{module}:mine/Corridor-v0")
    assert (made.id, made.asked, made.max_steps) == ("mine/Corridor-v0", f"{module}:mine/Corridor-v0", 9)
    assert made.describe()["id"] == "mine/Corridor-v0"
    del gymnasium.registry["mine/Corridor-v0"], sys.modules[module]
    # another process knows the environment only if the module comes along
    assert catalogue.make_live(pickle.loads(pickle.dumps(made))).observation_space.n == 3


def test_a_module_that_does_not_register_it_or_cannot_be_imported_is_told(module, tmp_path):
    with pytest.raises(UsageError, match="did you mean 'mine/Corridor-v0'") as error:
        make_environment(f"{module}:mine/Coridor-v0")
    assert code(error) == "D820"
    with pytest.raises(UsageError, match=r"no_such_module.*looked for in the current folder") as error:
        make_environment("no_such_module:mine/Corridor-v0")
    assert code(error) == "D843"
    (tmp_path / "broken_corridor.py").write_text("1 / 0")
    with pytest.raises(UsageError, match=r"cannot be imported \(division by zero\)"):
        make_environment("broken_corridor:mine/Corridor-v0")
    with pytest.raises(UsageError, match="D820"):
        make_environment("../broken:mine/Corridor-v0")


class Added:
    """An environment that another package brings."""

    @staticmethod
    def environment(args, rows):
        return Environment("Added-v0", args=args, map=rows, n_states=2)


def test_other_packages_add_environments(monkeypatch):
    point = EntryPoint("Added-v0", f"{__name__}:Added.environment", catalogue.GROUP)
    monkeypatch.setattr(EntryPoint, "load", lambda self: Added.environment)
    monkeypatch.setattr(catalogue, "entry_points", lambda group: (point,))
    made = make_environment("Added-v0", {"k": 1}, ["ab"])
    assert (made.n_states, made.args, made.map) == (2, {"k": 1}, ("ab",))


def test_a_broken_plug_in_is_named(monkeypatch):
    point = EntryPoint("Broken-v0", "no_such_module_here:environment", catalogue.GROUP)
    monkeypatch.setattr(catalogue, "entry_points", lambda group: (point,))
    with pytest.raises(UsageError, match=r"Broken-v0.*no_such_module_here") as error:
        make_environment("Broken-v0")
    assert code(error) == "D842"


def test_arguments_have_to_be_plain_values():
    with pytest.raises(UsageError) as error:
        make_environment("FrozenLake-v1", {"desc": object()})
    assert code(error) == "D821"


@pytest.mark.parametrize(
    "description",
    [None, "FrozenLake-v1", [], {}, {"id": 3}, {"id": "FrozenLake-v1", "args": []},
     {"id": "FrozenLake-v1", "map": "SFFG"}, {"id": "FrozenLake-v1", "map": [1]}],
)  # fmt: skip
def test_a_description_of_the_wrong_shape_is_refused(description):
    with pytest.raises(UsageError) as error:
        environment_of(description, file="d.json")
    assert code(error) == "D829"


def test_a_description_needs_only_an_id():
    assert environment_of({"id": "FrozenLake-v1", "args": None, "map": None}).n_states == 16


@pytest.mark.parametrize(
    ("text", "value"),
    [("true", True), ("False", False), ("3", 3), ("-2", -2), ("0.5", 0.5), ("1e-3", 1e-3), ("8x8", "8x8"),
     ("", ""), ("a=b", "a=b"), ("9" * 5000, float("inf")), ("nan", "nan")],
)  # fmt: skip
def test_arguments_on_the_command_line_have_their_natural_type(text, value):
    found = parse_env_args([f"key={text}"])["key"]
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize("texts", [["is_slippery"], ["=3"], ["a b=3"], ["a=1", "a=2"]])
def test_an_argument_that_cannot_be_read_is_refused(texts):
    with pytest.raises(UsageError) as error:
        parse_env_args(texts)
    assert code(error) == "D822"


def test_gymnasium_loads_only_when_an_environment_is_asked_for():
    program = "import stlspec.envs.catalogue, sys; print('gymnasium' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout == "False\n"


@pytest.mark.parametrize(
    ("text", "rows"), [("S.G", ("S.G",)), ("S..\n..G\n", ("S..", "..G")), ("\n  S..\n  ..G\n", ("S..", "..G"))]
)
def test_a_map_given_as_text_is_taken_by_its_lines(text, rows):
    assert make_environment("stlspec/GridWorld-v0", map_rows=text).map == rows
