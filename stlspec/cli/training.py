"""The command learn: from a spec, an environment and demonstrations to a policy.

In: options. Out: the output directory, and a short account on stdout; a progress bar on stderr.
"""

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stlspec.cli.data import (
    DemoEnv,
    DemoMap,
    EnvArgs,
    EnvOption,
    MapOption,
    demonstration_environment,
    environment_from,
)
from stlspec.cli.options import FormatOption, Params, read_params
from stlspec.cli.output import Format, print_json, warn
from stlspec.errors import UsageError, diagnostic

if TYPE_CHECKING:
    from stlspec.envs.model import Environment
    from stlspec.report import Progress


class Method(StrEnum):
    """How the policy is trained."""

    SHAPED = "shaped"
    PAPER = "paper"
    PLAIN = "plain"


class Base(StrEnum):
    """What a step pays."""

    SPEC = "spec"
    ENV = "env"


def learn(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="where policy, log and pictures go")],
    spec: Annotated[Path | None, typer.Argument(metavar="SPEC", help="a spec file or a compiled bundle")] = None,
    env: EnvOption = None,
    demos: Annotated[
        list[str] | None,
        typer.Option("--demos", metavar="DEMO...", help="demonstrations; takes every path up to the next option"),
    ] = None,
    reward: Annotated[
        Path | None,
        typer.Option("--reward", metavar="R.json", help="a reward map in place of demonstrations"),
    ] = None,
    params: Params = None,
    env_arg: EnvArgs = None,
    map_file: MapOption = None,
    demo_env: DemoEnv = None,
    demo_map: DemoMap = None,
    method: Annotated[Method, typer.Option("--method", help="how to train")] = Method.SHAPED,
    episodes: Annotated[int | None, typer.Option("--episodes", help="default: by the size of the map")] = None,
    seed: Annotated[int, typer.Option("--seed", help="same seed, same result")] = 0,
    max_steps: Annotated[
        int | None,
        typer.Option(
            "--max-steps",
            help="most steps of an episode, which goes from one goal to the next where there are several; default: the "
            "limit of the environment, else 4 for each state (of bins up to 1000), twice the longest demonstration, or "
            "as far as the spec looks, whichever is most",
        ),
    ] = None,
    gamma: Annotated[float, typer.Option("--gamma", help="discount")] = 0.99,
    alpha: Annotated[float, typer.Option("--alpha", help="learning rate")] = 0.1,
    epsilon: Annotated[float, typer.Option("--epsilon", help="share of random actions")] = 0.4,
    step_cost: Annotated[float, typer.Option("--step-cost", help="what each step costs")] = 0.01,
    mask: Annotated[
        bool | None,
        typer.Option(
            "--mask/--no-mask",
            help="never repeat a step that broke a hard requirement; by default where moves are deterministic",
            show_default=False,
        ),
    ] = None,
    base: Annotated[Base, typer.Option("--base", help="the spec's reward, or the environment's own")] = Base.SPEC,
    bins: Annotated[
        str | None,
        typer.Option("--bins", metavar="N[,N...]", help="bins for each entry of a continuous observation"),
    ] = None,
    jobs: Annotated[int, typer.Option("--jobs", help="processes, for segments between goals")] = 1,
    explain: Annotated[
        str | None,
        typer.Option("--explain", metavar="STATE", help="where the reward of a state comes from; needs --out alone"),
    ] = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Learn a policy that meets the requirements (Algorithms 1 to 3), or explain a finished run."""
    from stlspec import api, learning, report, rewards
    from stlspec.demos import common_environment, load_demonstrations

    if explain is not None:
        _explain(explain, out, output)
        return
    bundle = api.read(_complete(spec, demos, reward), read_params(params))
    environment = environment_from(env, env_arg, map_file)
    loaded = load_demonstrations(demos or [])
    environment = environment or _named(common_environment(loaded), len(loaded))
    with _progress(out) as bar:
        outcome = learning.learn(
            bundle,
            environment,
            loaded,
            rewards.load_reward(reward) if reward is not None else None,
            method=method.value,
            episodes=episodes,
            seed=seed,
            max_steps=max_steps,
            gamma=gamma,
            alpha=alpha,
            epsilon=epsilon,
            step_cost=step_cost,
            mask=mask,
            base=base.value,
            bins=_counts(bins),
            jobs=jobs,
            demo_environment=demonstration_environment(env, env_arg, map_file, demo_env, demo_map),
            out=out,
            progress=bar,
        )
    warn(outcome.warnings)
    if output is Format.JSON:
        print_json(outcome.to_json())
    else:
        report.print_outcome(outcome, bundle, environment, out, sys.stdout)
    if not outcome.meets_hard:
        raise typer.Exit(1)


def _named(common: "Environment | None", n_demonstrations: int) -> "Environment":
    """Return the environment that the demonstrations name, where no option does."""
    if common is None:
        why = "the demonstrations do not all name the same one" if n_demonstrations else "a reward map names none"
        way = f"name the environment to learn in: --env ID; {why}"
        raise UsageError([diagnostic("D880", what="missing option '--env'", help=way)])
    return common


def _complete(spec: Path | None, demos: list[str] | None, reward: Path | None) -> Path:
    """Return the spec, if all is there that learning takes; explaining takes less, so typer cannot ask for it."""
    if spec is None:
        way_out = "`--demos` takes every path up to the next option: put SPEC before it"
        raise UsageError([diagnostic("D880", what="missing argument 'SPEC'", help=way_out)])
    if (reward is None) == (not demos):
        what = "`learn` takes demonstrations or a reward map" + (", not both" if demos else "")
        raise UsageError([diagnostic("D880", what=what, help="give --demos DEMO... or --reward R.json, and --env ID")])
    return spec


def _explain(text: str, out: Path, output: Format) -> None:
    from stlspec import report
    from stlspec.learning import lessons

    found = lessons.explain(out, parse_state(text))
    if output is Format.JSON:
        print_json(found.to_json())
    else:
        report.print_source(found, sys.stdout)


def parse_state(text: str) -> int | tuple[int, int]:
    """Read a state as the user writes it: a number, or row and column as in 2,3 or [2, 3].

    Not in the paper: the command line.

    Raises: UsageError D880: it is neither.
    """
    found = re.fullmatch(r"\s*[\[(]?\s*(\d{1,9})\s*(?:,\s*(\d{1,9})\s*)?[\])]?\s*", text, re.ASCII)
    if found is None:
        what = f"'{text[:40]}' is no state: a state is a number, or row and column"
        raise UsageError([diagnostic("D880", what=what, help="write --explain 12, or --explain 2,3 on a map")])
    first, second = found.groups()
    return int(first) if second is None else (int(first), int(second))


def _counts(bins: str | None) -> tuple[int, ...] | None:
    """Read `--bins 50,50`."""
    if bins is None:
        return None
    parts = [part.strip() for part in bins.split(",")]
    if not all(part.isascii() and part.isdigit() and len(part) < 8 for part in parts):
        allowed = "whole numbers from 1, separated by commas, as in 50,50"
        found = diagnostic("D871", option="--bins", value=bins[:40], allowed=allowed)
        raise UsageError([replace(found, help="write --bins 50,50, or leave it out where states have numbers")])
    return tuple(map(int, parts))


@contextmanager
def _progress(out: Path) -> Iterator["Progress"]:
    """Show a bar on stderr while episodes go by; Ctrl-C says how to go on, if there is something to go on from."""
    from stlspec import report
    from stlspec.learning.storage import has_checkpoint

    try:
        with report.progress(sys.stderr) as bar:
            yield bar
    except KeyboardInterrupt:
        if has_checkpoint(out):
            print("the same command again goes on from the last checkpoint", file=sys.stderr)
        raise
