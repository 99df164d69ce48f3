"""The compiled spec with its methods: what other programs embed.

In: spec text, a spec file or a bundle file. Out: `Bundle`, the data of the compiler plus evaluation, saving and
the graph. The methods hold no logic of their own; they call the functions of the stages.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stlspec.compiler import bundle_file, files
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.compiling import compile_source
from stlspec.compiler.graph import to_networkx
from stlspec.errors import UsageError, diagnostic
from stlspec.markup.figures import standalone
from stlspec.markup.graphs import dag_svg
from stlspec.semantics.algebra import MIN_MAX, Algebra
from stlspec.semantics.ending import evaluate_ending
from stlspec.semantics.evaluation import Evaluation, RequirementResult
from stlspec.semantics.explain import Explanation, explain, named_values
from stlspec.semantics.gradients import gradient
from stlspec.semantics.layout import own_time
from stlspec.semantics.online import Monitor, make_monitor
from stlspec.semantics.online.monitor import Reading, Table
from stlspec.semantics.online.plan import Ends
from stlspec.source import SourceText

if TYPE_CHECKING:
    import networkx as nx


_ENDINGS = (".stl", ".stlspec", ".stlb")


@dataclass(frozen=True, repr=False, eq=False)
class Bundle(BundleData):
    """A compiled spec: immutable, safe to share between threads, equal where meaning and text are."""

    @cached_property
    def meaning_sha256(self) -> str:
        """The hash that alone decides "the same spec": of everything but text, file names and docs."""
        return bundle_file.meaning_sha256(self)

    @cached_property
    def source_sha256(self) -> str:
        """The hash of the text that the spec was compiled from."""
        return bundle_file.source_sha256(self)

    def __eq__(self, other: object) -> bool:
        """Compare by the two hashes: file names do not count."""
        if not isinstance(other, Bundle):
            return NotImplemented
        return (self.meaning_sha256, self.source_sha256) == (other.meaning_sha256, other.source_sha256)

    def __hash__(self) -> int:
        return hash((self.meaning_sha256, self.source_sha256))

    def evaluate(
        self, signals: Mapping[str, Any], time: Any = None, end: str = "clip", at: int = 0, algebra: Algebra = MIN_MAX
    ) -> "Evaluation[Any]":
        """Evaluate every requirement on one trace, a batch, or a ragged list of traces.

        Paper: Definition 5, quantitative semantics; the verdict is the Boolean semantics.

        Args:    signals: by name; each (n_samples,), or (n_traces, n_samples), or a list of arrays. The key `time`
                 means the stamps, as in files, unless the spec declares a signal of that name.
                 time: stamps of the same shape, in the spec's unit, where `signals` has none; None where samples
                 are counted or periodic.
                 end: "clip" (a trace is a complete episode), "strict" (it must reach the horizon) or "interval"
                 (it may go on: one trace, with `low` and `high`, and a verdict that may be undecided).
                 at: the sample whose value is wanted; negative counts from the end.
                 algebra: of `robustness` and `signal`; verdicts and witnesses are those of min/max in any.
        Returns: for each requirement robustness, verdict, witness, and its value at every sample.
        Raises:  DataError: a signal is missing, NaN, of another length, ...
                 UsageError: `end`, `at` or `algebra` is wrong, or there are stamps in both places.
        """
        stamps = self._stamps(signals, time)
        return evaluate_ending(self, signals, stamps, end=end, at=at, algebra=algebra)

    def gradient(
        self,
        signals: Mapping[str, Any],
        time: Any = None,
        requirement: str | None = None,
        algebra: Algebra = MIN_MAX,
    ) -> dict[str, Any]:
        """Differentiate the robustness of a requirement at sample 0 by every sample of every real signal.

        Args:    signals, time: as `evaluate`. requirement: its name; None: the only one there is.
                 algebra: min/max gives a subgradient at the witness, `log_sum_exp(T)` a smooth gradient.
        Returns: arrays by name of the signal, of the shape of its samples.
        Raises:  DataError: as `evaluate`. UsageError: no such requirement, or an algebra without slopes.
        """
        return gradient(self, signals, self._stamps(signals, time), requirement, algebra)

    def monitor(self, reading: Reading = "start", ends: Ends = "any", states: Table | None = None) -> Monitor:
        """Make a monitor: samples go in one by one, what is known of each requirement comes out.

        Not in the paper: it evaluates complete traces only.

        Args:    reading: "start" follows the value at sample 0, "every" gives the value at each sample once known.
                 ends: "any", or "horizon" if the trace is promised to reach the horizon.
                 states: the values of the signals in every state, by name (n_states,), or (n_states, n_signals)
                 in the order of the spec; a sample is then the number of a state.
        Raises:  UsageError: the reading, the end or the shape of `states` is wrong. DataError: a state has a
                 value that no sample may have.
        """
        return make_monitor(self, reading, ends, states)

    def explain(self, requirement: str, result: RequirementResult) -> Explanation:
        """Say which sub-formula, sample and signals decide a result of `evaluate`, and what would turn it."""
        return explain(self, requirement, result)

    def named_values(self, signals: Mapping[str, Any], time: Any = None) -> Mapping[str, NDArray[np.float64]]:
        """Return the value of every `let` that a requirement uses, at every sample of one trace or batch."""
        return named_values(self, signals, self._stamps(signals, time))

    def _stamps(self, signals: Mapping[str, Any], time: Any) -> Any:
        return own_time({signal.name for signal in self.signals}, signals, time)

    def to_networkx(self) -> "nx.DiGraph":
        """Return the DAG of requirements, edges from prerequisite to dependant, weights on the nodes."""
        return to_networkx(self)

    def dumps(self) -> bytes:
        """Return the bundle as canonical JSON, the same bytes wherever it is built."""
        return bundle_file.dump(self)

    def save(self, path: str | Path) -> None:
        """Write the bundle to a file, whole or not at all. Raises: InputError: it cannot be written."""
        files.write_bytes(path, self.dumps())

    def _repr_svg_(self) -> str | None:
        """Show the DAG of requirements in a notebook; None if it has none, or too many to be read."""
        graph = dag_svg(self)
        return None if graph is None else standalone(graph)

    def __repr__(self) -> str:
        """Show what it is, not all that it holds."""
        names = ", ".join(r.name for r in self.requirements[:5]) + (", ..." if self.requirements[5:] else "")
        return f"<Bundle {self.name or 'without a name'}: {names}; meaning {self.meaning_sha256[:12]}>"

    def __reduce__(self) -> tuple[Callable[[bytes], "Bundle"], tuple[bytes]]:
        """Pickle as the bundle file, so that worker processes get it checked."""
        return _loads, (self.dumps(),)


def publish(data: BundleData) -> Bundle:
    """Give the data of a compiled spec its methods."""
    return Bundle(**{field.name: getattr(data, field.name) for field in fields(BundleData)})


def _loads(data: bytes) -> Bundle:
    return publish(bundle_file.load(data))


def compile(  # noqa: A001
    spec: str | Path, params: Mapping[str, float | str] | None = None, *, folder: str | Path | None = None
) -> Bundle:
    """Compile a spec.

    Args:    spec: the text of a spec, or the path of a spec file as a `Path`.
             params: values of params; a number is in the declared unit, a text such as "12s" is converted.
             folder: where a text finds the files that it uses; None: it may use none. A file finds them beside it.
    Returns: the bundle.
    Raises:  SpecError: the text has errors (`.diagnostics`). InputError: the file cannot be used, or a param
             has no value.
    """
    if isinstance(spec, Path):
        return publish(compile_source(files.read_source(spec), params, files.read_used))
    if not isinstance(spec, str) or (spec.endswith(_ENDINGS) and len(spec.split()) == 1):
        shown = spec if isinstance(spec, str) else type(spec).__name__
        what = f"`compile` takes the text of a spec, or a `Path`, not {shown!r}"
        way = "for a file write compile(Path(...)), for a bundle load(...)"
        raise UsageError([diagnostic("D880", what=what, help=way)])
    if folder is None:
        return publish(compile_source(SourceText.of("<text>", spec), params))
    return publish(compile_source(SourceText.of(str(Path(folder) / "<text>"), spec), params, files.read_used))


def load(path: str | Path) -> Bundle:
    """Load a compiled bundle from a file; nothing in it is executed.

    Raises: InputError: it cannot be read. BundleError: it is damaged, foreign or was changed.
    """
    return publish(files.read_bundle(path))


def read(path: str | Path, params: Mapping[str, float | str] | None = None) -> Bundle:
    """Compile a spec file, or load it if it is a bundle.

    Raises: SpecError, InputError, BundleError as `compile` and `load`; UsageError: params with a bundle.
    """
    return publish(files.read_spec(path, params))
