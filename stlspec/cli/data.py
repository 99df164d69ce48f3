"""The commands on demonstrations: score, reward, eval.

In: a spec or a formula, and data files. Out: tables, JSON, CSV, a reward map. The heavy stages are imported at
the head of each command, so that the other commands start fast.
"""

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stlspec.cli.many import (
    Address,
    EngineName,
    EngineOption,
    Jobs,
    KeepGoing,
    Out,
    Sharing,
    expanded,
    score_in_memory,
    score_into,
)
from stlspec.cli.options import FormatOption, Params, read_params, spare_inputs
from stlspec.cli.output import Format, ScoreFormat, print_json, warn
from stlspec.cli.streaming import STDIN, check_stdin, score_stdin
from stlspec.compiler.printing import counted
from stlspec.errors import UsageError, diagnostic

if TYPE_CHECKING:
    from collections.abc import Callable

    from stlspec.api import Bundle
    from stlspec.envs.model import Environment
    from stlspec.scores import Ranking
    from stlspec.semantics.explain import Explanation


class Gate(StrEnum):
    """Which requirements every demonstration must meet."""

    HARD = "hard"
    ALL = "all"


class End(StrEnum):
    """What the end of a trace means."""

    CLIP = "clip"
    STRICT = "strict"
    INTERVAL = "interval"


class OnNan(StrEnum):
    """What to do with a sample that is not a number."""

    REFUSE = "refuse"
    HOLD = "hold"
    DROP = "drop"


Spec = Annotated[Path, typer.Argument(metavar="SPEC", help="a spec file or a compiled bundle")]
Data = Annotated[
    list[str],
    typer.Argument(metavar="DEMO...", help="demonstrations: CSV, JSON, JSONL, NPZ, Parquet; - is CSV on stdin"),
]
EndOption = Annotated[End, typer.Option("--end", help="what the end of a trace means")]
OnNanOption = Annotated[OnNan, typer.Option("--on-nan", help="what to do with a NaN")]
Resample = Annotated[
    str | None,
    typer.Option("--resample", metavar="PERIOD", help="take every signal at a steady period, such as 100ms"),
]
EnvOption = Annotated[str | None, typer.Option("--env", metavar="ID", help="the environment, by gymnasium id")]
EnvArgs = Annotated[
    list[str] | None,
    typer.Option("--env-arg", metavar="KEY=VALUE", help="an argument of the environment; may be repeated"),
]
MapOption = Annotated[Path | None, typer.Option("--map", metavar="FILE", help="its map, rows of text")]
DemoEnv = Annotated[str | None, typer.Option("--demo-env", metavar="ID", help="the environment of the demonstrations")]
DemoMap = Annotated[Path | None, typer.Option("--demo-map", metavar="FILE", help="the map of the demonstrations")]


def environment_from(
    env: str | None, args: list[str] | None, map_file: Path | None, map_option: str = "--map"
) -> "Environment | None":
    """Make the environment that the options describe; None if they describe none."""
    from stlspec.envs.catalogue import make_environment, parse_env_args, read_map

    if env is None:
        for option, given in (("--env-arg", args), (map_option, map_file)):
            if given:
                what = f"`{option}` needs an environment"
                raise UsageError([diagnostic("D880", what=what, help="name one with `--env ID`")])
        return None
    here = str(Path.cwd())
    if ":" in env and here not in sys.path:
        # MODULE:ID: the command lies elsewhere, and the module beside the spec; last, so that it hides none
        sys.path.append(here)
    rows = read_map(map_file) if map_file is not None else None
    return make_environment(env, parse_env_args(args or []), rows, file=str(map_file) if map_file else None)


def demonstration_environment(
    env: str | None,
    args: list[str] | None,
    map_file: Path | None,
    demo_env: str | None,
    demo_map: Path | None,
) -> "Environment | None":
    """Make the environment on which demonstrations were made, where it is not the one of the run."""
    if demo_env is None and demo_map is None:
        return None
    other = demo_env is not None and demo_env != env
    rows = demo_map if demo_map is not None or other else map_file
    return environment_from(demo_env or env, None if other else args, rows, "--demo-map")


def score(
    spec: Spec,
    demonstrations: Data,
    params: Params = None,
    require: Annotated[
        Gate | None, typer.Option("--require", help="exit with 1 unless every demonstration meets these")
    ] = None,
    at: Annotated[
        int | None, typer.Option("--at", metavar="K", help="values at sample K; negative counts from the end")
    ] = None,
    end: EndOption = End.CLIP,
    on_nan: OnNanOption = OnNan.REFUSE,
    env: EnvOption = None,
    env_arg: EnvArgs = None,
    map_file: MapOption = None,
    demo_env: DemoEnv = None,
    demo_map: DemoMap = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="say what decides each value, and what would turn it")
    ] = False,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="OUT", help="a folder, or a .png or .svg file, for pictures")
    ] = None,
    page: Annotated[
        Path | None, typer.Option("--report", metavar="OUT.html", help="a page for a browser, one file, with pictures")
    ] = None,
    resample: Resample = None,
    jobs: Jobs = None,
    engine: EngineOption = EngineName.LOCAL,
    address: Address = None,
    keep_going: KeepGoing = False,
    out: Out = None,
    output: Annotated[ScoreFormat, typer.Option("--format", help="how to print")] = ScoreFormat.TEXT,
) -> None:
    """Score and rank demonstrations against a spec, and say why they fail."""
    from stlspec import api
    from stlspec.many.work import job_of
    from stlspec.sampling import period_of

    if STDIN in demonstrations:
        more: dict[str, object] = {"--explain": explain, "--plot": plot, "--report": page, "--map": map_file}
        more |= {"--env": env or demo_env, "--jobs": jobs, "--out": out, "--keep-going": keep_going}
        more |= {"--engine": engine is EngineName.RAY, "--end interval": end is End.INTERVAL}
        more |= {"--at": at is not None, "--resample": resample}
        check_stdin(demonstrations, more)
    _check_explained(explain, output)
    sharing = Sharing(jobs, engine, address, keep_going, out)
    sharing.check(bool(explain or plot or page), require is not None, [spec, *demonstrations])
    if page is not None:
        _check_page(page, [spec, *demonstrations])
    bundle = api.read(spec, read_params(params))
    environment = demonstration_environment(env, env_arg, map_file, demo_env, demo_map) or environment_from(
        env, env_arg, map_file
    )
    options: dict[str, Any] = {"end": end.value, "at": at, "on_nan": on_nan.value}
    options["resample"] = None if resample is None else period_of(resample)
    if out is not None:
        summary = score_into(
            out, job_of(bundle, environment, **options), expanded(demonstrations), sharing, output is ScoreFormat.JSON
        )
        raise typer.Exit(1 if summary.failed else 0)
    explanations: Any = []
    left_out = False
    if STDIN in demonstrations:
        ranking = score_stdin(bundle, end.value, on_nan.value)
    elif sharing.wanted:
        job = job_of(bundle, environment, **options)
        ranking, left_out = score_in_memory(job, expanded(demonstrations), sharing)
    else:
        ranking, explanations = _score_all(bundle, expanded(demonstrations), environment, options, explain, plot, page)
    _print_scores(ranking, explanations if explain else None, output)
    if _gate_fails(ranking, require) or left_out:
        raise typer.Exit(1)


def _score_all(
    bundle: "Bundle",
    paths: list[str],
    environment: "Environment | None",
    options: dict[str, Any],
    explain: bool,
    plot: Path | None,
    page: Path | None,
) -> "tuple[Ranking, list[dict[str, Explanation]]]":
    """Score in this process with all traces at hand, draw what is wanted, and explain."""
    from stlspec import scores
    from stlspec.binding import columns_of
    from stlspec.demos import load_demonstrations
    from stlspec.pages.score_page import score_page

    loaded = load_demonstrations(paths, columns_of(bundle, environment))
    draw = _plotter(plot, len(loaded)) if plot is not None else None
    ranking = scores.score(bundle, loaded, environment, **options)
    warn(found for demonstration in ranking.demonstrations for found in demonstration.warnings)
    explanations = _explanations(bundle, ranking) if explain or draw else []
    if draw is not None:
        draw(bundle, ranking, explanations)
    if page is not None:
        sampling = {key: options[key] for key in ("on_nan", "resample")}
        _write_page(page, score_page(bundle, ranking, loaded, environment, **sampling))
    return ranking, explanations


def _print_scores(ranking: "Ranking", explanations: "list[dict[str, Explanation]] | None", output: ScoreFormat) -> None:
    from stlspec import report

    if output is ScoreFormat.JSON:
        print_json(ranking.to_json() if explanations is None else _with_explanations(ranking, explanations))
    elif output is ScoreFormat.CSV:
        print(report.ranking_csv(ranking), end="")
    else:
        report.print_ranking(ranking, sys.stdout)
        if explanations is not None:
            _print_explanations(ranking, explanations)


def _gate_fails(ranking: "Ranking", require: Gate | None) -> bool:
    """Say how many demonstrations fail the gate, if any."""
    failed = _failed(ranking, require) if require is not None else 0
    if failed:
        what = f"{failed} of {counted(len(ranking.demonstrations), 'demonstration')} failed `--require {require}`"
        warn([diagnostic("D881", what=what, help="the result above says why")])
    return failed > 0


def _check_explained(explain: bool, output: ScoreFormat) -> None:
    if explain and output is ScoreFormat.CSV:
        what = "a CSV table has no room for explanations"
        raise UsageError([diagnostic("D880", what=what, help="use --format json, or leave out --explain")])


def _check_page(page: Path, inputs: "list[str | Path]") -> None:
    """Refuse, before any work, a report over an input or under a name that a browser would not open."""
    if page.suffix.lower() not in (".html", ".htm"):
        what = f"`--report {page.name}` does not name an HTML file"
        raise UsageError([diagnostic("D880", what=what, help="end its name in .html")])
    spare_inputs(page, inputs, "--report")


def _write_page(page: Path, text: str) -> None:
    from stlspec.compiler.files import write_bytes

    write_bytes(page, text.encode())
    print(f"report: {page}", file=sys.stderr)


def _explanations(bundle: "Bundle", ranking: "Ranking") -> "list[dict[str, Explanation]]":
    """Explain every requirement on every demonstration."""
    from stlspec.semantics.explain import explain

    return [{n: explain(bundle, n, x.evaluated) for n, x in d.requirements.items()} for d in ranking.demonstrations]


def _with_explanations(ranking: "Ranking", explanations: "list[dict[str, Explanation]]") -> dict[str, Any]:
    """Return the document of the scores, with an explanation in each requirement."""
    document = ranking.to_json()
    for row, found in zip(document["demonstrations"], explanations, strict=True):
        for name, explanation in found.items():
            row["requirements"][name]["explanation"] = explanation.to_json()
    return document


def _print_explanations(ranking: "Ranking", explanations: "list[dict[str, Explanation]]") -> None:
    """Print the explanations of each demonstration, best first as in the table."""
    rows = sorted(zip(ranking.demonstrations, explanations, strict=True), key=lambda row: -(row[0].rank or 0))
    for demonstration, found in rows:
        print(f"\n{demonstration.name}")
        for explanation in found.values():
            print("\n".join(f"  {line}" for line in explanation.lines()))


def _plotter(out: Path, n_demonstrations: int) -> "Callable[[Bundle, Ranking, list[dict[str, Explanation]]], None]":
    """Check, before any work, that pictures can be drawn; return what draws them."""
    from stlspec.pictures.contents import picture_of
    from stlspec.pictures.drawing import check_target, draw_picture, picture_files

    check_target(out, n_demonstrations)

    def draw(bundle: "Bundle", ranking: "Ranking", explanations: "list[dict[str, Explanation]]") -> None:
        files = picture_files(out, [d.name for d in ranking.demonstrations])
        for file, demonstration, found in zip(files, ranking.demonstrations, explanations, strict=True):
            draw_picture(picture_of(bundle, demonstration, found), file)
            print(f"drawn: {file}", file=sys.stderr)

    return draw


def _failed(ranking: "Ranking", gate: Gate) -> int:
    """Count the demonstrations that do not satisfy the requirements that the gate names."""
    named = [name for name, strength, _, _ in ranking.requirements if gate is Gate.ALL or strength == "hard"]
    return sum(
        any(d.requirements[name].result.verdict.value != "satisfied" for name in named) for d in ranking.demonstrations
    )


def reward(
    spec: Spec,
    demonstrations: Data,
    out: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="the reward map to write")],
    params: Params = None,
    env: EnvOption = None,
    env_arg: EnvArgs = None,
    map_file: MapOption = None,
    demo_env: DemoEnv = None,
    demo_map: DemoMap = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Infer the reward of every state from ranked demonstrations (Algorithm 1)."""
    from stlspec import api, report, rewards
    from stlspec.compiler.files import write_bytes
    from stlspec.demos import load_demonstrations

    spare_inputs(out, [spec, *demonstrations])
    bundle = api.read(spec, read_params(params))
    environment = demonstration_environment(env, env_arg, map_file, demo_env, demo_map) or environment_from(
        env, env_arg, map_file
    )
    found = rewards.infer_reward(bundle, load_demonstrations(demonstrations), environment)
    warn(found.warnings())
    document = found.to_json()
    write_bytes(out, report.json_bytes(document))
    if output is Format.JSON:
        print_json(document)
    else:
        report.print_reward(found, str(out), sys.stdout)


def evaluate_formula(
    formula: Annotated[str, typer.Argument(metavar="FORMULA", help="such as 'always (x > 0)'")],
    files: Annotated[list[str], typer.Argument(metavar="DATA...", help="traces: CSV, JSON, JSONL, NPZ")],
    params: Params = None,
    time: Annotated[str, typer.Option("--time", metavar="TIME", help="as in a spec: step, s, '100 ms'")] = "step",
    at: Annotated[int, typer.Option("--at", metavar="K", help="the sample whose value is shown")] = 0,
    end: EndOption = End.CLIP,
    on_nan: OnNanOption = OnNan.REFUSE,
    output: FormatOption = Format.TEXT,
) -> None:
    """Evaluate one formula on data; no spec file is needed."""
    from stlspec import report
    from stlspec.demos import load_demonstrations
    from stlspec.formulas import evaluate_on

    results = evaluate_on(
        formula, load_demonstrations(files), time, read_params(params), end=end.value, at=at, on_nan=on_nan.value
    )
    if output is Format.JSON:
        print_json(report.formula_document(formula, results))
    else:
        report.print_formula(results, sys.stdout)
    if any(r.result.verdict.value == "violated" for r in results):
        raise typer.Exit(1)
