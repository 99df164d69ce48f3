"""Evaluation under every reading of the end of a trace.

In: what `evaluate` takes. Out: its results; with the end "interval" they also carry the enclosure of the robustness
over every way the trace can go on, and a verdict that may be undecided. This stands above the offline engine and
the online one, since an enclosure on a recorded trace is what a monitor knows after the last sample.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

from stlspec.compiler.bundle import BundleData
from stlspec.errors import UsageError, diagnostic
from stlspec.semantics.algebra import MIN_MAX, Algebra
from stlspec.semantics.evaluation import Evaluation, RequirementResult, evaluate
from stlspec.semantics.online import interval_evaluate

End = Literal["clip", "strict", "interval"]


def evaluate_ending(
    bundle: BundleData,
    signals: Mapping[str, Any],
    time: Any = None,
    *,
    end: str = "clip",
    at: int = 0,
    file: str | None = None,
    algebra: Algebra = MIN_MAX,
) -> Evaluation[Any]:
    """Evaluate every requirement; see `evaluation.evaluate` for the arguments.

    Not in the paper: it takes a demonstration as complete.

    Args:    end: "clip", "strict", or "interval" for one trace in the min/max algebra.
    Returns: results; with "interval" `low` and `high` enclose the robustness, which is then the clip value.
    Raises:  as `evaluate`; UsageError D880: an unknown end, or "interval" for several traces.
    """
    if end != "interval":
        if end not in ("clip", "strict"):
            what = f"there is no end {end!r}"
            raise UsageError([diagnostic("D880", file=file, what=what, help="use clip, strict or interval")])
        whole: Literal["clip", "strict"] = "strict" if end == "strict" else "clip"
        return evaluate(bundle, signals, time, end=whole, at=at, file=file, algebra=algebra)
    clipped = evaluate(bundle, signals, time, at=at, file=file)
    if algebra is not MIN_MAX or not all(isinstance(result, RequirementResult) for result in clipped.values()):
        way = "evaluate them one by one, in min/max"
        raise UsageError([diagnostic("D880", file=file, what="`end='interval'` takes one trace", help=way)])
    enclosed = interval_evaluate(bundle, signals, time, at=at, file=file)
    return Evaluation(
        {
            name: replace(result, verdict=enclosed[name].verdict, low=enclosed[name].low, high=enclosed[name].high)
            for name, result in clipped.items()
        }
    )
