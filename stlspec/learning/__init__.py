"""Policies from inferred rewards: Algorithm 2 of the paper, for one goal and a table of deterministic moves.

The data flows one way through the modules:
task (spec and environment as tables over states) and settings -> evidence (demonstrations as a reward map and
first entries of the mask) -> shaping (what a step pays) and promises (the potential) -> qstl (training) ->
policy (the greedy path) -> farming (what goes wrong with the reward as printed) -> outcome -> results, plots,
storage (the directory of a run), with resume for interrupted runs. `training.learn` is the whole line.
"""

from stlspec.learning.outcome import Outcome, Training
from stlspec.learning.policy import Policy, load_policy
from stlspec.learning.training import learn

__all__ = ["Outcome", "Policy", "Training", "learn", "load_policy"]
