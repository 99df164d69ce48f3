"""Whether demonstrations are long enough for what a spec asks of them.

In: a checked spec and demonstration files. Out: L614 for each requirement whose horizon some of them do not reach.
"""

from collections.abc import Sequence

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.model import Model
from stlspec.compiler.notation import ticks_text
from stlspec.demos import Demonstration, load_demonstrations
from stlspec.errors import Diagnostic, diagnostic
from stlspec.sampling import in_unit_of
from stlspec.source import SourceText
from stlspec.traces import time_ticks


def uncovered(source: SourceText, bundle: BundleData, model: Model, demos: Sequence[str]) -> list[Diagnostic]:
    """Compare the horizon of every requirement with the length of every demonstration.

    Not in the paper: windows that no demonstration reaches are not tested by them.

    Args:    source, bundle, model: a spec without errors, whose params are bound. demos: paths of demonstrations.
    Raises:  DataError: a demonstration cannot be read.
    """
    lengths = [_length(demonstration, bundle) for demonstration in load_demonstrations(list(demos))]
    found = []
    for requirement in bundle.requirements:
        horizon = requirement.horizon
        shorter = [length for length in lengths if horizon is not None and length < horizon]
        if shorter:
            found.append(
                diagnostic(
                    "L614",
                    source=source,
                    span=model.declared.requirements[requirement.name].name.span,
                    name=requirement.name,
                    horizon=ticks_text(horizon, bundle.time),
                    count=f"{len(shorter)} of {len(lengths)} demonstrations",
                    shortest=ticks_text(min(shorter), bundle.time),
                )
            )
    return found


def _length(demonstration: Demonstration, bundle: BundleData) -> int:
    """Return the time from the first to the last sample, in ticks."""
    recording = in_unit_of(demonstration.recording, bundle.time)
    ticks = time_ticks(bundle.time, recording.n_samples, recording.time, demonstration.file)
    return int(ticks[-1] - ticks[0])
