"""The files of a finished run.

In: an `Outcome`. Out: the files in the output directory, all or none. Every file is worked out from the
outcome alone, so two equal runs write equal files, but for the seconds in result.json.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from stlspec.compiler.bundle import BundleData
from stlspec.envs.model import Environment
from stlspec.learning import plots, storage
from stlspec.learning.outcome import Outcome
from stlspec.learning.policy import FILE as POLICY
from stlspec.learning.task import Task

Writer = Callable[[Path], object]


def publish(outcome: Outcome, task: Task, environment: Environment, bundle: BundleData, directory: Path) -> Outcome:
    """Write the results of a run into its directory, and name them in the outcome.

    Not in the paper: the output of the command.

    Args:    directory: as `storage.claim` returned it.
    Returns: the outcome with `files` filled in.
    Raises:  UsageError D872: the directory cannot be written.
    """
    scene = plots.Scene(
        title=f"{bundle.title or bundle.name}: reward and learned path ({outcome.method})",
        values=outcome.reward.table(environment),
        endings=task.endings,
        start=task.start,
        path=outcome.states,
        n_columns=environment.n_columns,
    )
    named = {"result": storage.RESULT, "policy": POLICY, "reward": "reward.json", "log": "episodes.csv"}
    if plots.available():
        named |= {"reward_map": "reward.png", "curve": "curve.png"}
    else:
        named["reward_map"] = "reward.txt"
    outcome = replace(outcome, files=MappingProxyType(named))
    writers: dict[str, Writer] = {
        named["result"]: _text(storage.dumps(outcome.to_json())),
        named["policy"]: _text(storage.dumps(outcome.policy.to_json())),
        named["reward"]: _text(storage.dumps(outcome.reward.to_json())),
        named["log"]: _text(outcome.log.to_csv()),
        named["reward_map"]: _text(plots.reward_text(scene)),
    }
    if "curve" in named:
        writers[named["reward_map"]] = lambda place: plots.draw_reward(scene, place)
        writers[named["curve"]] = lambda place: _draw_curve(outcome, bundle, place)
    storage.publish(directory, writers)
    return outcome


def _text(text: str) -> Writer:
    return lambda place: place.write_text(text, encoding="utf-8", newline="\n")


def _draw_curve(outcome: Outcome, bundle: BundleData, place: Path) -> None:
    title = f"{bundle.title or bundle.name}: training ({outcome.method}, seed {outcome.seed})"
    log, first = outcome.log, outcome.training.episodes_to_success
    plots.draw_curve(log.steps, log.endings, first, title, place)
