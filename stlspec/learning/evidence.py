"""What the demonstrations contribute to training: the reward map, and the first entries of the mask.

In: demonstrations, or a reward map inferred before. Out: `Evidence`. Nothing is learned here. A bad
demonstration says which transition violates; that is true on the map it was made on and nowhere else, so only
demonstrations with the very same transition table enter the mask.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.demos import Demonstration
from stlspec.envs.catalogue import environment_of
from stlspec.envs.model import Environment
from stlspec.errors import Diagnostic, StlspecError, diagnostic
from stlspec.learning.shaping import VIOLATION
from stlspec.learning.task import Task, followed
from stlspec.rewards import RankedStates, RewardMap, ranked_states, reward_of

Pair = tuple[int, int]
"""A state and an action."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What training starts from.

    reward: the map R. at_home: whether it was all made on the very map that is learned on. violating: pairs of
    state and action that bad demonstrations showed to violate. bad: how many there are; bad_elsewhere: how many
    of them were made on another transition table. ranked: all demonstrations, as Algorithm 1 sees them.
    given: whether the reward map was given instead of inferred from them.
    """

    reward: RewardMap
    at_home: bool
    violating: tuple[Pair, ...]
    bad: int
    bad_elsewhere: int
    warnings: tuple[Diagnostic, ...]
    ranked: tuple[RankedStates, ...] = ()
    given: bool = False

    @property
    def doubts(self) -> tuple[Diagnostic, ...]:
        """What is doubtful about the demonstrations themselves, whatever training makes of them."""
        return tuple(warning for demonstration in self.ranked for warning in demonstration.warnings)


def gather(
    bundle: BundleData,
    task: Task,
    environment: Environment,
    demonstrations: Iterable[Demonstration],
    reward: RewardMap | None,
    demo_environment: Environment | None,
) -> Evidence:
    """Turn demonstrations into a reward map and pairs to mask.

    Paper: Algorithm 1; its section 3.2 for learning on another map than the demonstrations were made on.

    Args:    bundle: the compiled spec. task: tables of the environment to learn in. environment: that one.
             demonstrations: may be empty. reward: a map inferred before; None = from the demonstrations.
             demo_environment: where they were made, unless they say so themselves; None = `environment`.
    Returns: the evidence, with a warning for a reward that is 0 everywhere or comes from another spec.
    Raises:  DataError: a demonstration cannot be used (see `infer_reward`).
    """
    ranked, given = ranked_states(bundle, demonstrations, demo_environment or environment), reward is not None
    warnings: list[Diagnostic] = []
    at_home = all(same_table(demonstration, environment) for demonstration in ranked)
    if reward is None:
        reward = reward_of(bundle, ranked, demo_environment or environment)
    else:
        at_home = made_in(reward, environment)
        if reward.meaning_sha256 != meaning_sha256(bundle):
            warnings.append(diagnostic("D865"))
    if reward.all_zero:
        reason = "" if ranked else ": there are no demonstrations"
        warnings.append(diagnostic("D864", reason=reason))
    bad = [demonstration for demonstration in ranked if demonstration.label == "bad"]
    here = [d for d in bad if same_table(d, environment)]
    pairs = {pair for d in here for pair in violating_pairs(task, d.states)}
    return Evidence(
        reward, at_home, tuple(sorted(pairs)), len(bad), len(bad) - len(here), tuple(warnings), ranked, given
    )


def gathered(
    bundle: BundleData, demonstrations: Iterable[Demonstration], reward: RewardMap | None, home: Environment
) -> Evidence:
    """Turn demonstrations into a reward map only: where transitions are by chance, no step is known to violate.

    Paper: Algorithm 1. Arguments, result and errors as for `gather`; home: where demonstrations were made.
    """
    ranked, given = ranked_states(bundle, demonstrations, home), reward is not None
    warnings: list[Diagnostic] = []
    if reward is None:
        reward = reward_of(bundle, ranked, home)
    elif reward.meaning_sha256 != meaning_sha256(bundle):
        warnings.append(diagnostic("D865"))
    if reward.all_zero:
        reason = "" if ranked else ": there are no demonstrations"
        warnings.append(diagnostic("D864", reason=reason))
    bad = sum(demonstration.label == "bad" for demonstration in ranked)
    return Evidence(reward, False, (), bad, bad, tuple(warnings), ranked, given)


def same_table(demonstration: RankedStates, environment: Environment) -> bool:
    """Tell whether a demonstration was made on the very transition table that is learned on.

    Not in the paper: on an unseen map the old obstacles may be free.
    """
    known = demonstration.environment.fingerprint
    return known is not None and known == environment.fingerprint


def made_in(reward: RewardMap, environment: Environment) -> bool:
    """Tell whether a reward map says that it was inferred on the very transition table that is learned on.

    Not in the paper: on an unseen map the order of its states may mislead.
    """
    try:
        home = environment_of(reward.environment)
    except StlspecError:
        return False  # a map for every state may come from an environment that is not installed here
    return home.fingerprint is not None and home.fingerprint == environment.fingerprint


def violating_pairs(task: Task, states: Sequence[int]) -> set[Pair]:
    """Collect the pairs of state and action by which a demonstration entered a violating state.

    Not in the paper: Algorithm 2 forgets what it violated; the mask remembers.

    Args:    task: tables over learner states. states: of the environment, of a demonstration, (n_samples,).
    Returns: every action that leads from one learner state to the next, where that one violates.
    """
    return {
        (before, action)
        for before, after in pairwise(followed(task, states))
        if before is not None and after is not None and task.endings[after] == VIOLATION
        for action, reached in enumerate(task.transitions[before])
        if reached == after
    }


def notes(evidence: Evidence, method: str, mask: bool) -> tuple[str, ...]:
    """Say what bad demonstrations did, and how far the reward is trusted. Not in the paper: the report."""
    bad = _notes_on_bad(evidence, method, mask)
    if method == "shaped" and not evidence.at_home and not evidence.reward.all_zero:
        return (*bad, "the reward was inferred on another map, so it shapes little: its order may mislead here")
    return bad


def _notes_on_bad(evidence: Evidence, method: str, mask: bool) -> tuple[str, ...]:
    if not evidence.bad:
        return ()
    count = f"{evidence.bad} bad demonstration{'' if evidence.bad == 1 else 's'}"
    if method == "paper" or not mask:
        use = "only the reward map can show" if method == "paper" else "training does not use"
        return (f"{count}: no mask, so {use} what went wrong",)
    used = evidence.bad - evidence.bad_elsewhere
    if not used:
        return (f"{count}, made on another map: what was forbidden there may be free here, so nothing is masked",)
    pairs = len(evidence.violating)
    known = f"{pairs} step{'' if pairs == 1 else 's'} forbidden from the start"
    elsewhere = "" if used == evidence.bad else f" ({evidence.bad - used} made on another map)"
    return (f"{count}{elsewhere}: {known}; training does not use their values in the reward map",)
