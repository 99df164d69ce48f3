"""Enclosures on recorded signals: `--end interval`.

In: a compiled spec and a trace that may go on. Out: for each requirement what is known of its value at a sample,
the same that a monitor knows after the last sample. Settled formulas come from the offline engine.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stlspec.compiler.bundle import BundleData
from stlspec.semantics.evaluation import Verdict
from stlspec.semantics.online.arrays import enclosures, needed, stretch, three
from stlspec.semantics.online.plan import Ends, make_plan
from stlspec.semantics.robustness import evaluate_nodes, shown
from stlspec.traces import Trace, make_trace

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Enclosed:
    """What is known of a requirement on a trace that may go on; ties are shown as 0.

    low, high: enclose its robustness over every way the trace can go on. robustness: its value if the trace ends
    here. verdict: undecided if it can still change. lows, highs: low and high at every sample, (n_samples,).
    """

    low: float
    high: float
    robustness: float
    verdict: Verdict
    lows: Floats
    highs: Floats


def interval_evaluate(
    bundle: BundleData,
    signals: Mapping[str, ArrayLike],
    time: ArrayLike | None = None,
    at: int = 0,
    ends: Ends = "any",
    file: str | None = None,
) -> dict[str, Enclosed]:
    """Enclose the value of every requirement at a sample of one trace that may go on.

    Not in the paper: it evaluates complete traces only.

    Args:    signals: for each signal (n_samples,) values. time: time stamps in the spec's unit. at: the sample,
             from 0; negative counts from the end. ends: as `make_monitor`. file: for messages.
    Returns: by requirement.
    Raises:  DataError: the signals cannot be used, or an expression has no value. IndexError: no sample `at`.
    """
    used = {str(node.value) for node in bundle.nodes if node.op in ("signal", "bool")}
    trace = make_trace(bundle.time, bundle.signals, signals, time, required=used, file=file)
    return enclose_trace(bundle, trace, at, ends)


def enclose_trace(bundle: BundleData, trace: Trace, at: int = 0, ends: Ends = "any") -> dict[str, Enclosed]:
    """Enclose the requirements on one trace that was made before; else as `interval_evaluate`."""
    plan = make_plan(bundle, ends)
    roots = [r.root for r in bundle.requirements]
    inputs, others = needed(plan, roots)
    # All expressions, as if every requirement were asked for everywhere: the same samples are refused.
    evaluate_nodes(bundle.nodes, roots, trace)
    columns = evaluate_nodes(plan.nodes, inputs, trace)
    found = enclosures(stretch(plan, trace.times), inputs, others, columns)
    return {r.name: _enclosed(three(found[r.root]), at) for r in bundle.requirements}


def _enclosed(values: Floats, at: int) -> Enclosed:
    low, high, _ = values[at]
    verdict = Verdict.SATISFIED if low > 0 else Verdict.VIOLATED if high < 0 else Verdict.UNDECIDED
    visible = shown(values)
    visible.flags.writeable = False
    lows, highs, _ = visible.T
    shown_low, shown_high, robustness = map(float, visible[at])
    return Enclosed(shown_low, shown_high, robustness, verdict, lows, highs)
