"""Algorithm 1 measured: what it takes, what it gives to demonstrations, how near it comes to the ground truth.

In: cases. Out: figures as JSON. Times are those of the inference alone, with spec, environment and demonstrations
in memory, and those of a fresh Python process that reads everything, which is what a user waits for.
"""

import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from stlspec.paper.cases import Case, case_of
from stlspec.paper.maps import GOALS, OBSTACLES
from stlspec.rewards import RewardMap, infer_reward
from stlspec.scores import score
from stlspec.semantics.evaluation import Verdict

COLD = "import sys; from stlspec.paper.inference import infer; infer(sys.argv[1])"
"""What a fresh process runs."""


def infer(name: str) -> RewardMap:
    """Infer the reward of a case by its name, from nothing."""
    case = case_of(name)
    return infer_reward(case.bundle(), case.demonstrations(), case.environment())


def time_inference(case: Case, repeats: int) -> dict[str, Any]:
    """Time the inference of a reward.

    Paper: Table 1, "Ours".

    Args:    repeats: of the inference; a third as many, but at least one, of a fresh process.
    Returns: demonstrations, samples and states (counts), seconds and cold (medians, wall clock), valued (states
             with a reward other than 0).
    """
    bundle, environment, demonstrations = case.bundle(), case.environment(), case.demonstrations()
    infer_reward(bundle, demonstrations, environment)
    taken = []
    for _ in range(repeats):
        began = time.perf_counter()
        reward = infer_reward(bundle, demonstrations, environment)
        taken.append(time.perf_counter() - began)
    return {
        "demonstrations": len(demonstrations),
        "samples": sum(d.n_samples for d in demonstrations),
        "states": environment.size,
        "seconds": float(np.median(taken)),
        "valued": len(reward.values),
    }


def time_cold(case: Case, repeats: int) -> float:
    """Time a fresh process that infers the reward of a case; the median in seconds."""
    taken = []
    for _ in range(repeats):
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", COLD, case.name], check=True)  # noqa: S603 - our own interpreter
        taken.append(time.perf_counter() - began)
    return float(np.median(taken))


def worth(case: Case) -> list[dict[str, Any]]:
    """Say what each demonstration is worth.

    Paper: equation (2), and definitions 3 and 4.

    Returns: for each demonstration its kind, label, reward r_d and rank.
    """
    found = score(case.bundle(), case.demonstrations(), environment=case.environment())
    rows = []
    for (kind, _), d in zip(case.demos, found.demonstrations, strict=True):
        strict = all(r.result.robustness > 0 for r in d.requirements.values())
        hard = d.requirements["avoid"].result.verdict is Verdict.SATISFIED
        rows.append(
            {"kind": kind, "label": d.label, "reward": d.reward, "rank": d.rank, "strict": strict, "hard": hard}
        )
    return rows


def ground_truth(rows: Sequence[str]) -> list[float]:
    """Return the reward that the paper takes as the truth of a map.

    Paper: section 4, figure 5: 2 at the goal, 0 in obstacles, 1 elsewhere.

    Returns: (n_states,).
    """
    return [2.0 if mark in GOALS else 0.0 if mark in OBSTACLES else 1.0 for row in rows for mark in row]


def correlation(values: Sequence[float], truth: Sequence[float]) -> float | None:
    """Return Pearson's correlation of two rewards over all states; None where one of them is constant.

    Not in the paper: it compares rewards by eye. Scale and offset of a reward do not count.
    """
    a, b = np.asarray(values, dtype=np.float64), np.asarray(truth, dtype=np.float64)
    if np.ptp(a) == 0 or np.ptp(b) == 0 or not np.isfinite(a).all():
        return None
    # Scaled first: what another program found may be so large that its square is none.
    return float(np.corrcoef((a - a.min()) / np.ptp(a), b)[0, 1])
