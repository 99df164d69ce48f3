"""Small worlds to record in, and a sitting in each."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
import pytest

import stlspec
from stlspec.envs.catalogue import make_environment
from stlspec.tools.record.session import Session
from stlspec.tools.record.storage import DemoFile
from stlspec.tools.record.world import World

SPEC = """spec s "A <b>small</b> spec"
signal d_obs
signal d_goal
hard avoid: always (d_obs >= 1)
soft reach "Get there" depends on avoid: eventually (d_goal < 1)
"""
ROWS = ("..G", ".#.", "S..")


class Lamp(gymnasium.Env[Any, Any]):
    """A light whose brightness is turned; draws itself, ends at 3, and can be told to misbehave."""

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"]}
    action_space = gymnasium.spaces.Discrete(3, start=-1)
    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (2,))

    def __init__(self, render_mode: str | None = None, fault: str = "") -> None:
        self.render_mode, self.fault = render_mode, fault
        self._resets = 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self._resets += 1
        self._level = float(self.np_random.integers(100)) if self.fault == "random" else 0.0
        if self.fault == "forgetful":
            self._level = 10.0 * self._resets
        return self._observed(), {"watts": 0.0}

    def step(self, action: int) -> Any:
        if self.fault == "step":
            raise ZeroDivisionError("the fuse blew")
        self._level += action
        level = np.nan if self.fault == "nan" else self._level
        return np.array([level, 0.5]), 0.0, self._level >= 3, False, {"watts": 60.0 * self._level}

    def render(self) -> Any:
        if self.fault == "render":
            raise RuntimeError("no bulb")
        if self.fault == "pygame":
            raise gymnasium.error.DependencyNotInstalled("pygame is not installed")
        frame = np.zeros((4, 6, 3), dtype=np.uint8)
        frame[..., 0] = int(40 * abs(self._level)) % 256
        return frame

    def _observed(self) -> Any:
        return np.array([self._level, 0.5])


if "stlspec-tests/Lamp-v0" not in gymnasium.registry:
    gymnasium.register("stlspec-tests/Lamp-v0", entry_point=Lamp)

Sit = Callable[..., Session]


@pytest.fixture
def sit(tmp_path: Path) -> Iterator[Sit]:
    """Begin sittings; each goes to the same file unless told otherwise."""
    worlds: list[World] = []

    def begin(spec: str | None = SPEC, env: str = "stlspec/GridWorld-v0", rows: Any = ROWS, args: Any = None,
              file: str = "demos.jsonl", seed: int = 0) -> Session:  # fmt: skip
        environment = make_environment(env, args, rows)
        bundle = stlspec.compile(spec) if spec is not None else None
        held = DemoFile(tmp_path / file)
        worlds.append(World(environment, seed))
        return Session(bundle, worlds[-1], held)

    yield begin
    for world in worlds:
        world.close()


@pytest.fixture
def lamp(sit: Sit) -> Callable[..., Session]:
    """Begin sittings with the lamp."""

    def begin(spec: str | None = None, fault: str = "") -> Session:
        return sit(spec, "stlspec-tests/Lamp-v0", None, {"fault": fault} if fault else None)

    return begin
