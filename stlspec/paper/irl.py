"""The baseline of the paper's Table 1: maximum causal entropy inverse reinforcement learning, measured here.

In: a case and demonstrations. Out: an `IrlResult`: how long MCE-IRL takes for a stated number of iterations, and
the reward that it arrives at. The implementation is that of the library imitation, which needs gymnasium below 1.0:
it runs in an environment of its own (`libraries`), and what goes there and comes back are files. What comes back
is checked like any other input. Whatever stands in the way of a measurement is a result that says so.
"""

import contextlib
import math
import os
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stlspec.demos import Demonstration
from stlspec.documents import DamageError, read_document
from stlspec.errors import InputError
from stlspec.paper.cases import Case
from stlspec.paper.libraries import MCE_IRL, cache, find
from stlspec.paper.tabular import Tabular, make_tabular

SCHEMA = "stlspec.mce-irl/1"
SCRIPT = Path(__file__).with_name("mce_irl.py")

ITERATIONS = 1000
"""The budget: imitation's own default for `MCEIRL.train`."""

FULL_STATES = 1000
"""Tasks with more states are not trained to the end: `TIMED_STEPS` gradient steps are timed and extrapolated."""

TIMED_STEPS = 3

MOST_DENSE = 2**27
"""Entries, 1 GiB: larger transition tables are given to imitation in sparse form, which is faster."""

_LOADING = 120.0
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
# as ours has one; tables this small gain nothing by more, and on a machine with other work threads wait for each other
_LARGEST_ANSWER = 64 * 2**20
_ENDINGS = ("converged", "steps", "seconds")
_ABSENT = "its libraries are not installed: python -m stlspec.paper.libraries"


@dataclass(frozen=True, slots=True)
class IrlResult:
    """What MCE-IRL took and found.

    skipped: why there is no measurement; then there is no time and no reward, and all other numbers are 0.
    iterations: the budget, gradient steps. steps: those that were taken. seconds: for the budget, or up to
    convergence; extrapolated: steps times the median step, not measured whole. step_seconds: median of a gradient
    step. gradient: l2 norm at the end. gap: the largest difference between the state visits of the demonstrations
    and those of the policy. converged: whether one of imitation's criteria was met (gap 1e-3, gradient 1e-4).
    reward: (n_states,), no unit; None where training was not done to the end. horizon, n_states, demonstrations: of
    the task. sparse: transitions in sparse form. note: one sentence for a report. versions: of the libraries.
    """

    skipped: str | None
    iterations: int = 0
    steps: int = 0
    seconds: float | None = None
    step_seconds: float = 0.0
    extrapolated: bool = False
    gradient: float = 0.0
    gap: float = 0.0
    converged: bool = False
    reward: tuple[float, ...] | None = None
    horizon: int = 0
    n_states: int = 0
    demonstrations: int = 0
    sparse: bool = False
    note: str = ""
    versions: tuple[tuple[str, str], ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return the result as plain JSON values."""
        return {**asdict(self), "reward": None if self.reward is None else list(self.reward),
                "versions": dict(self.versions)}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Answer:
    """What the script found. Fields as in `IrlResult`; ended: "converged", "steps" or "seconds"."""

    versions: tuple[tuple[str, str], ...]
    steps: int
    seconds: float
    step_seconds: float
    gradient: float
    gap: float
    ended: str
    reward: tuple[float, ...]


def measure(
    case: Case,
    demonstrations: Sequence[Demonstration],
    *,
    iterations: int = ITERATIONS,
    seconds: float = 600.0,
    steps: int | None = None,
    sparse: bool | None = None,
    folder: Path | None = None,
) -> IrlResult:
    """Measure MCE-IRL on a case.

    Paper: Table 1 and section 4, "we also compared our method with MCE-IRL".

    Args:    demonstrations: at least one, with states; the paper gave 10 to 800 optimal ones. iterations: the
             budget. seconds: training stops after the first step that ends later; then the time is extrapolated
             to the budget. steps: gradient steps to take; None = the budget, or `TIMED_STEPS` where there are
             more than `FULL_STATES` states. sparse: give the library sparse transitions; None = where dense
             ones would be larger than `MOST_DENSE`. folder: of the environment that `libraries` made.
    Returns: the result; it says so if the libraries are absent, fail or take too long.
    """
    python = find(folder or cache() / "mce-irl", MCE_IRL)
    if python is None:
        return IrlResult(_ABSENT)
    try:
        tabular = make_tabular(case.bundle(), case.environment(), demonstrations)
    except InputError as error:
        return IrlResult(error.diagnostics[0].message)
    if steps is None:
        steps = iterations if tabular.n_states <= FULL_STATES else TIMED_STEPS
    if sparse is None:
        sparse = tabular.n_states**2 * tabular.n_actions > MOST_DENSE
    try:
        answer = ask(python, tabular, steps=min(steps, iterations), seconds=seconds, sparse=sparse)
    except DamageError as error:
        return IrlResult(str(error))
    return _result(answer, tabular, iterations, len(demonstrations), sparse)


def _result(answer: Answer, tabular: Tabular, iterations: int, demonstrations: int, sparse: bool) -> IrlResult:
    converged = answer.ended == "converged"
    extrapolated = not converged and answer.steps < iterations
    seconds = answer.step_seconds * iterations if extrapolated else answer.seconds
    return IrlResult(
        None, iterations, answer.steps, seconds, answer.step_seconds, extrapolated, answer.gradient, answer.gap,
        converged, None if extrapolated else answer.reward, tabular.horizon, tabular.n_states, demonstrations, sparse,
        _note(answer, iterations, extrapolated, sparse), answer.versions,
    )  # fmt: skip


def _note(answer: Answer, iterations: int, extrapolated: bool, sparse: bool) -> str:
    kind = ", transitions in sparse form" if sparse else ""
    if extrapolated:
        return f"{answer.steps} gradient steps timed, extrapolated to {iterations:,}{kind}"
    if answer.ended == "converged":
        return f"converged after {answer.steps:,} gradient steps{kind}"
    return f"all {answer.steps:,} gradient steps taken, not converged (visits differ by up to {answer.gap:.2g}){kind}"


def ask(
    python: Path, tabular: Tabular, *, steps: int, seconds: float, sparse: bool = False, limit: float | None = None,
    script: Path | None = None,
) -> Answer:  # fmt: skip
    """Train MCE-IRL in another interpreter.

    Not in the paper: how its libraries are kept apart from ours.

    Args:    python: the interpreter. steps, seconds: at which training stops, whichever comes first. limit: seconds
             after which the process is killed; None = as training needs, with time to load. script: what to run, None =
             `SCRIPT`.
    Returns: the answer, checked.
    Raises:  DamageError: the process fails, takes too long, or its answer is damaged.
    """
    with tempfile.TemporaryDirectory(prefix="stlspec-") as folder:
        problem, answer, log = (Path(folder) / name for name in ("problem.npz", "answer.json", "log.txt"))
        tables = {name: getattr(tabular, name) for name in Tabular.__dataclass_fields__}
        np.savez(problem, **tables, steps=steps, seconds=seconds, sparse=sparse)
        with log.open("wb") as errors:
            # The script ends when its input does: should this process be killed, the system closes the pipe.
            process = subprocess.Popen(  # noqa: S603 - an interpreter that the user made, and our own script
                [str(python), "-I", str(script or SCRIPT), str(problem), str(answer)],
                stdin=subprocess.PIPE, stdout=errors, stderr=errors, cwd=folder, env=os.environ | _ONE_THREAD,
            )  # fmt: skip
            code = _wait(process, _LOADING + 2 * seconds if limit is None else limit)
        if code:
            raise DamageError(f"the process of MCE-IRL failed: {_last_line(log)}")
        return read_answer(answer, tabular.n_states, steps)


def _wait(process: "subprocess.Popen[bytes]", limit: float) -> int:
    try:
        return process.wait(limit)
    except subprocess.TimeoutExpired:
        raise DamageError(f"MCE-IRL took longer than {limit:g} s") from None
    finally:
        process.kill()
        process.wait()
        if process.stdin is not None:
            with contextlib.suppress(OSError):
                process.stdin.close()


def _last_line(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 2000))
        lines = file.read().decode("utf-8", "replace").split("\n")
    words = [line.strip() for line in lines if line.strip()]
    return "".join(c for c in (words or ["it said nothing"])[-1] if c.isprintable())[:200]


def read_answer(path: Path, n_states: int, steps: int) -> Answer:
    """Read what the script found, and check all of it.

    Not in the paper: a file format.

    Args:    n_states, steps: of the problem.
    Raises:  DamageError: something in it is missing, of the wrong kind, or cannot be.
    """
    document = read_document(path, SCHEMA, _LARGEST_ANSWER)
    reward, versions, taken = document.get("reward"), document.get("versions"), document.get("steps")
    if not isinstance(reward, list) or len(reward) != n_states or not all(map(_is_number, reward)):
        raise DamageError(f"'reward' must be {n_states} finite numbers")
    if not isinstance(versions, dict) or len(versions) > 20 or not all(isinstance(v, str) for v in versions.values()):
        raise DamageError("'versions' must be texts by name")
    if type(taken) is not int or not 1 <= taken <= steps:
        raise DamageError(f"'steps' must be a whole number from 1 to {steps}")
    if document.get("ended") not in _ENDINGS:
        raise DamageError(f"'ended' must be one of {', '.join(_ENDINGS)}")
    shown = tuple((str(name)[:40], text[:40]) for name, text in sorted(versions.items()))
    numbers = {name: _measure(document, name) for name in ("seconds", "step_seconds", "gradient", "gap")}
    return Answer(
        versions=shown, steps=taken, ended=str(document["ended"]), reward=tuple(map(float, reward)), **numbers
    )


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) < 1e300 and math.isfinite(value)


def _measure(document: Mapping[str, Any], name: str) -> float:
    value = document.get(name)
    if not _is_number(value) or value < 0:  # type: ignore[operator]
        raise DamageError(f"'{name}' must be a finite number, 0 or more")
    return float(value)  # type: ignore[arg-type]
