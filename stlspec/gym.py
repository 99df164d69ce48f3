"""`stlspec.gym.STLReward`: a spec as the reward of any reinforcement-learning library.

Importing this module costs nothing; gymnasium is loaded when the wrapper is first used. It is no replacement for
gymnasium and does not stand in its way: `import gymnasium` stays what it is.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stlspec.wrapper import STLReward

__all__ = ["STLReward"]


def __getattr__(name: str) -> Any:
    """Load the wrapper when it is asked for."""
    if name not in __all__:
        raise AttributeError(f"module 'stlspec.gym' has no attribute {name!r}")
    value = getattr(import_module("stlspec.wrapper"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
