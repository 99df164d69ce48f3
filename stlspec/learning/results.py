"""The files of a finished run.

In: an `Outcome`. Out: the files in the output directory, all or none. Every file is worked out from the
outcome alone, so two equal runs write equal files, but for the seconds in result.json.
"""

from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from types import MappingProxyType

from stlspec.compiler.bundle import BundleData
from stlspec.envs.model import Environment
from stlspec.errors import Diagnostic, diagnostic
from stlspec.learning import plots, storage
from stlspec.learning.lessons import FILE as LESSONS
from stlspec.learning.outcome import Outcome
from stlspec.learning.policy import FILE as POLICY
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION
from stlspec.learning.task import World

Writer = Callable[[Path], object]


def publish(
    outcome: Outcome,
    endings: tuple[int, ...],
    start: int,
    environment: Environment,
    bundle: BundleData,
    directory: Path,
) -> Outcome:
    """Write the results of a run into its directory, and name them in the outcome.

    Not in the paper: the output of the command.

    Args:    endings: (n_states,), what each state is drawn as, see `marks`. start: where the path begins.
             directory: as `storage.claim` returned it.
    Returns: the outcome with `files` filled in, and a warning D877 for each picture that could not be drawn.
    Raises:  UsageError D872: the directory cannot be written.
    """
    scene = plots.Scene(
        title=_title(bundle, f"reward and learned path ({outcome.method})"),
        values=outcome.reward.table(environment),
        endings=endings,
        start=start,
        path=outcome.states,
        n_columns=environment.n_columns,
        stops=tuple(outcome.states[sample] for sample in outcome.stops) if len(outcome.stops) > 1 else (),
        zones=zones(environment),
    )
    named = {"result": storage.RESULT, "policy": POLICY, "reward": "reward.json", "log": "episodes.csv"}
    named["lessons"] = LESSONS
    pictures, warnings = _pictures(outcome, scene, bundle) if plots.available() else ({}, ())
    if "reward_map" not in pictures:
        pictures["reward_map"] = ("reward.txt", plots.reward_text(scene).encode())
    named |= {kind: name for kind, (name, _) in pictures.items()}
    outcome = replace(outcome, files=MappingProxyType(named), warnings=(*outcome.warnings, *warnings))
    writers: dict[str, Writer] = {
        named["result"]: _text(storage.dumps(outcome.to_json())),
        named["policy"]: _text(storage.dumps(outcome.policy.to_json())),
        named["reward"]: _text(storage.dumps(outcome.reward.to_json())),
        named["log"]: _text(outcome.log.to_csv()),
        named["lessons"]: _text(storage.dumps(outcome.lessons.to_json())),
    }
    writers |= {name: _bytes(data) for name, data in pictures.values()}
    storage.publish(directory, writers)
    return outcome


def zones(environment: Environment) -> tuple[str, ...]:
    """Return the letter of the named region that each cell of a map belongs to, "" = none; () without such a map.

    Not in the paper: pictures.
    """
    letters = tuple(cell if "a" <= cell <= "z" else "" for row in environment.map or () for cell in row)
    return letters if any(letters) and len(letters) == environment.n_states else ()


def marks(world: World) -> tuple[int, ...]:
    """Return what each state of the environment is drawn as: forbidden, a goal, or neither.

    Not in the paper: pictures.
    """
    goals = [any(column) for column in zip(*(visit.holds for visit in world.visits), strict=True)]
    forbidden = world.product.forbidden
    return tuple(VIOLATION if bad else GOAL if goal else RUNS for bad, goal in zip(forbidden, goals, strict=True))


Pictures = dict[str, tuple[str, bytes]]
"""For each kind of picture its file and what is in it."""


def _pictures(outcome: Outcome, scene: plots.Scene, bundle: BundleData) -> tuple[Pictures, tuple[Diagnostic, ...]]:
    """Draw what can be drawn, before any file is written; what cannot be drawn becomes a warning."""
    title = _title(bundle, f"training ({outcome.method}, seed {outcome.seed})")
    log, first = outcome.log, outcome.training.episodes_to_success
    drawers: dict[str, tuple[str, Callable[[BytesIO], None]]] = {
        "reward_map": ("reward.png", lambda stream: plots.draw_reward(scene, stream)),
        "curve": ("curve.png", lambda stream: plots.draw_curve(log.steps, log.endings, first, title, stream)),
    }
    drawn, warnings = Pictures(), []
    for kind, (name, draw) in drawers.items():
        stream = BytesIO()
        try:
            draw(stream)
        except Exception as error:
            # a picture is never worth the run: matplotlib may fail by its fonts, its settings, its memory
            problem = " ".join(f"{type(error).__name__}: {error}".split())[:200]
            warnings.append(diagnostic("D877", picture=name, problem=problem))
        else:
            drawn[kind] = (name, stream.getvalue())
    return drawn, tuple(warnings)


def _title(bundle: BundleData, what: str) -> str:
    return ": ".join(filter(None, [bundle.title or bundle.name, what]))


def _text(text: str) -> Writer:
    return _bytes(text.encode("utf-8"))


def _bytes(data: bytes) -> Writer:
    return lambda place: place.write_bytes(data)
