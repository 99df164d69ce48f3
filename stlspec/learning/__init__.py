"""Policies from inferred rewards: Algorithms 2 and 3 of the paper, over tables of deterministic moves.

The data flows one way through the modules:
goals and orders (what the spec wants visited) and memory and product (what its hard requirements remember),
over tables of conditions, make a task; settings -> evidence (demonstrations as a reward map and first entries
of the mask) -> shaping (what a step pays) and promises (the potential) -> qstl (training) -> segments (from a
state to a goal, shaped by guidance, kept by resume) -> tours and chains (through several goals) -> conclusion
-> outcome, with policy and route, lessons and farming -> results, plots, account, storage (the directory of a
run). Where transitions are by chance or between bins, experience (with chance, runs and satisfaction) takes the
place of the middle. `training.learn` is the whole line, `many.learn_many` many of them at once.
"""

from stlspec.learning.many import learn_many
from stlspec.learning.outcome import Outcome, Training
from stlspec.learning.policy import Policy, load_policy
from stlspec.learning.training import learn

__all__ = ["Outcome", "Policy", "Training", "learn", "learn_many", "load_policy"]
