"""`stlspec.gym`: light until used, and in nobody's way."""

import subprocess
import sys

import pytest

PROBE = """
import sys
import stlspec
import stlspec.gym
heavy = {"numpy", "gymnasium", "networkx", "rich", "typer"} & set(sys.modules)
assert not heavy, heavy
assert stlspec.gym is sys.modules["stlspec.gym"]
import gymnasium
assert "stlspec" not in gymnasium.__file__
stlspec.gym.STLReward
assert "stlspec.wrapper" in sys.modules
"""


def test_importing_it_loads_nothing_and_shadows_nothing():
    subprocess.run([sys.executable, "-c", PROBE], check=True, timeout=60)


def test_it_has_the_wrapper_and_nothing_else():
    import stlspec.gym

    assert dir(stlspec.gym) == ["STLReward"]
    with pytest.raises(AttributeError, match="nothing"):
        stlspec.gym.nothing  # noqa: B018
