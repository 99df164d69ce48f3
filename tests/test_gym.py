"""`stlspec.gym`: in nobody's way, and the environment is known once it is imported."""

import subprocess
import sys

import pytest


def run(*lines):
    subprocess.run([sys.executable, "-c", "\n".join(lines)], check=True, timeout=60)


def test_only_asking_for_it_loads_gymnasium_and_nothing_is_shadowed():
    run(
        "import sys",
        "import stlspec",
        "assert not {'numpy', 'gymnasium', 'networkx', 'rich', 'typer'} & set(sys.modules)",
        "assert stlspec.gym is sys.modules['stlspec.gym']",
        "import gymnasium",
        "assert 'stlspec' not in gymnasium.__file__",
        "assert stlspec.gym.STLReward is sys.modules['stlspec.wrapper'].STLReward",
    )


MAKE = "assert gymnasium.make('stlspec/GridWorld-v0', map=['SG']).reset()[0] == 0"


@pytest.mark.parametrize(
    "lines",
    [
        ("import stlspec.gym", "import gymnasium", MAKE),
        ("import gymnasium", "import stlspec.gym", MAKE),
        ("import gymnasium", MAKE.replace("'stlspec/", "'stlspec.gym:stlspec/")),
        ("import stlspec.gym, gymnasium", MAKE.replace("'stlspec/", "'stlspec.gym:stlspec/")),
    ],
)
def test_gymnasium_makes_the_grid_world(lines):
    run(*lines)


def test_loading_a_policy_makes_the_grid_world_known(tmp_path):
    run(
        "import gymnasium, stlspec",
        "try:",
        f"    stlspec.load_policy({str(tmp_path)!r})",
        "except stlspec.DataError:",
        "    pass",
        MAKE,
    )
