"""stlspec: a declarative language and compiler toolkit for Signal Temporal Logic.

The names below are the public surface; everything else may change. They are loaded when first used, so that
`import stlspec` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stlspec.api import Bundle, compile, load  # noqa: A004
    from stlspec.demos import Demonstration, load_demonstrations
    from stlspec.envs.catalogue import make_environment
    from stlspec.errors import (
        BundleError,
        DataError,
        Diagnostic,
        InputError,
        SpecError,
        StlspecError,
        UsageError,
    )
    from stlspec.learning import Outcome, Policy, learn, load_policy
    from stlspec.rewards import RewardMap, infer_reward, load_reward
    from stlspec.scores import Ranking, score
    from stlspec.semantics.algebra import BOOLEAN, MIN_MAX, Algebra, log_sum_exp
    from stlspec.semantics.evaluation import Evaluation, Verdict, Witness
    from stlspec.semantics.explain import Explanation
    from stlspec.semantics.online import Monitor

__version__ = "0.1.0"

_HOMES = {
    "stlspec.api": ("Bundle", "compile", "load"),
    "stlspec.demos": ("Demonstration", "load_demonstrations"),
    "stlspec.envs.catalogue": ("make_environment",),
    "stlspec.errors": (
        "BundleError",
        "DataError",
        "Diagnostic",
        "InputError",
        "SpecError",
        "StlspecError",
        "UsageError",
    ),
    "stlspec.learning": ("Outcome", "Policy", "learn", "load_policy"),
    "stlspec.rewards": ("RewardMap", "infer_reward", "load_reward"),
    "stlspec.scores": ("Ranking", "score"),
    "stlspec.semantics.algebra": ("BOOLEAN", "MIN_MAX", "Algebra", "log_sum_exp"),
    "stlspec.semantics.evaluation": ("Evaluation", "Verdict", "Witness"),
    "stlspec.semantics.explain": ("Explanation",),
    "stlspec.semantics.online": ("Monitor",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "BOOLEAN",
    "MIN_MAX",
    "Algebra",
    "Bundle",
    "BundleError",
    "DataError",
    "Demonstration",
    "Diagnostic",
    "Evaluation",
    "Explanation",
    "InputError",
    "Monitor",
    "Outcome",
    "Policy",
    "Ranking",
    "RewardMap",
    "SpecError",
    "StlspecError",
    "UsageError",
    "Verdict",
    "Witness",
    "__version__",
    "compile",
    "infer_reward",
    "learn",
    "load",
    "load_demonstrations",
    "load_policy",
    "load_reward",
    "log_sum_exp",
    "make_environment",
    "score",
]


def __getattr__(name: str) -> Any:
    """Load the module that a public name lives in; `stlspec.gym` is a module itself."""
    if name == "gym":
        return import_module("stlspec.gym")
    if name not in _HOME:
        raise AttributeError(f"module 'stlspec' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
