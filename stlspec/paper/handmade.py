"""Q-learning with hand-crafted rewards, matched: the same learner, mask and cost of a step as ours.

In: a run, as `runs` has them. Out: its row. The paper compares with "standard Q-Learning with hand-crafted rewards"
and does not say which; here they are the two that everybody writes. Sparse: 1 at the goal, -1 at a violation, the
cost of a step. By distance: besides, every step pays less the farther from the goal it ends, the textbook's way of
making a reward dense. On Mountain Car the hand-crafted reward is the environment's own: `learn` with base "env".
"""

from dataclasses import dataclass, fields, replace
from functools import partial
from inspect import signature

import numpy as np

from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning import learn, resume
from stlspec.learning.conclusion import conclude
from stlspec.learning.evidence import gather
from stlspec.learning.segments import Job, trainer
from stlspec.learning.settings import Settings, make_settings
from stlspec.learning.task import SETTLED, lifted, make_world, segment
from stlspec.learning.tours import Key, Search
from stlspec.learning.training import Judge, search_tours
from stlspec.paper.runs import Row, Run, row_of

SPARSE, BY_DISTANCE = "sparse", "by distance"
REWARDS = (SPARSE, BY_DISTANCE)

FARTHEST = 0.1
"""What a step that ends as far from the goal as the map allows costs more than one that ends at the goal. On a map of
8 x 8 the way to the goal costs about as much by distance as the goal pays; with ten times as much, to violate at once
would be the best that Q-learning can do."""


_CHOICES = {f.name for f in fields(Settings)}


@dataclass
class Paid(Search):
    """A search whose segments pay for entering states. payoffs: (n_states,) of the environment, () = nothing."""

    payoffs: tuple[float, ...] = ()

    def job(self, key: Key) -> Job:
        """Return the job that trains a segment, see `Search.job`."""
        job = super().job(key)
        task = replace(job.task, payoffs=lifted(job.task, self.payoffs) if self.payoffs else ())
        return replace(job, task=task)


def payoffs(environment: Environment, reward: str) -> tuple[float, ...]:
    """Return what a hand-crafted reward pays for entering each state, besides the base reward.

    Paper: section 4, "hand-crafted rewards".

    Args:    environment: with the signal d_goal, the distance to its one goal, in cells. reward: one of `REWARDS`.
    Returns: (n_states,), in [-`FARTHEST`, 0]; () for the sparse one.
    Raises:  UsageError D880: there is no such distance.
    """
    if reward == SPARSE:
        return ()
    if "d_goal" not in environment.signal_names or "d_goal_2" in environment.signal_names:
        what = f"'{environment.id}' has no distance to one goal for a hand-crafted reward"
        raise UsageError([diagnostic("D880", what=what, help="take the sparse reward")])
    distance = environment.signals(["d_goal"], np.arange(environment.n_states))["d_goal"]
    return tuple((-FARTHEST * distance / distance.max()).tolist())


def _settings(run: Run, environment: Environment) -> Settings:
    as_in_learn = {name: p.default for name, p in signature(learn).parameters.items() if name in _CHOICES}
    return make_settings(environment, **as_in_learn | dict(run.options) | {"method": "plain", "seed": run.seed})


def make_handmade(run: Run) -> Row:
    """Make one run of Q-learning on a hand-crafted reward.

    Paper: section 4 and figure 4. Not in the paper: mask and cost of a step are ours, and bad demonstrations fill
    the mask before the start as they do for ours, so that only the reward differs.

    Args:    run: its method is one of `REWARDS`; the environment has deterministic transitions.
    Returns: its row, as `runs.make_run`.
    Raises:  UsageError D869, D880: the environment has no table, or no distance to one goal.
    """
    home, case = run.home or run.case, run.case
    bundle, environment = case.bundle(), case.environment()
    settings = _settings(run, environment)
    world = make_world(bundle, environment, settings.max_steps)
    whole = segment(world, world.product.start, SETTLED)
    demonstrations = () if run.none else home.demonstrations(*run.kinds)
    evidence = gather(bundle, whole, environment, demonstrations, None, home.environment())
    search = Paid(
        world, settings, (0.0,) * environment.n_states, set(evidence.violating) if settings.mask else set(),
        partial(resume.fingerprint, bundle, environment), None, payoffs=payoffs(environment, run.method),
    )  # fmt: skip
    judge = Judge(bundle, environment, world)
    with trainer(1) as trained:
        tour = search_tours(search, trained, judge)
    return row_of(conclude(search, tour, judge, judge.evaluate(tour.path), bundle, environment, evidence), case)
