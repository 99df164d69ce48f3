"""Whether demonstrations offer what a spec asks of them: its signals, and enough time.

In: a checked spec and demonstration files. Out: what `score` would refuse them for, such as D804 for a signal that a
file lacks, and L614 for each requirement whose horizon some of them do not reach.
"""

from collections.abc import Sequence

from stlspec.binding import bind
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.model import Model
from stlspec.compiler.notation import ticks_text
from stlspec.demos import Demonstration, load_demonstrations
from stlspec.errors import DataError, Diagnostic, diagnostic
from stlspec.sampling import in_unit_of
from stlspec.source import SourceText
from stlspec.traces import time_ticks


def uncovered(source: SourceText, bundle: BundleData, model: Model, demos: Sequence[str]) -> list[Diagnostic]:
    """Compare the signals of a spec with those of every demonstration, and every horizon with its length.

    Not in the paper: windows that no demonstration reaches are not tested by them.

    Args:    source, bundle, model: a spec without errors, whose params are bound. demos: paths of demonstrations.
    Raises:  DataError: a demonstration cannot be read.
    """
    demonstrations = load_demonstrations(list(demos))
    found = [problem for demonstration in demonstrations for problem in _unbound(demonstration, bundle)]
    lengths = [_length(demonstration, bundle) for demonstration in demonstrations]
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


def _unbound(demonstration: Demonstration, bundle: BundleData) -> tuple[Diagnostic, ...]:
    """Return what keeps the signals of a spec from being found; states wait for the environment of `score --env`."""
    recording = demonstration.recording
    if recording.states is not None and recording.env is None:
        return ()
    try:
        bind(bundle, demonstration)
    except DataError as error:
        return error.diagnostics
    return ()


def _length(demonstration: Demonstration, bundle: BundleData) -> int:
    """Return the time from the first to the last sample, in ticks."""
    recording = in_unit_of(demonstration.recording, bundle.time)
    ticks = time_ticks(bundle.time, recording.n_samples, recording.time, demonstration.file)
    return int(ticks[-1] - ticks[0])
