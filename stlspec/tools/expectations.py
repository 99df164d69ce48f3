"""Specs carry their own tests: the `expect` statements of a spec, run on data.

In: a spec file, values of params, an environment that computes missing signals. Out: an `Outcome` for each
statement, as soon as it is known: met, not met, or not to be run because its data cannot be used. What is not met
is explained with the sample that decides, the sub-formulas there, and the margin. Files are found from the spec.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from stlspec.binding import bind
from stlspec.compiler import bundle_file, files
from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.compiler.compiling import compile_syntax
from stlspec.compiler.expectations import TIME
from stlspec.compiler.ir import reachable
from stlspec.compiler.printing import number_text
from stlspec.demos import Demonstration, load_demonstrations, make_demonstration
from stlspec.envs.model import Environment
from stlspec.errors import Diagnostic, InputError, UsageError, diagnostic
from stlspec.lang.nodes import (
    DataFile,
    ExpectStatement,
    InlineData,
    LabelExpectation,
    Number,
    RankExpectation,
    VerdictExpectation,
)
from stlspec.lang.parse import Syntax
from stlspec.lang.using import parse_with_uses
from stlspec.scores import DemonstrationScore, Ranking, evaluate_demonstrations, rank_demonstrations
from stlspec.semantics.ending import evaluate_ending
from stlspec.semantics.evaluation import RequirementResult, Verdict
from stlspec.semantics.explain import Explanation, explain

_FILES_KEPT = 16
_VERDICTS = {"holds": Verdict.SATISFIED, "fails": Verdict.VIOLATED}


@dataclass(frozen=True, slots=True)
class Case:
    """What one demonstration shows of an expectation.

    met: it is as expected. what: how it is, in a line. details: what lies behind that, for a person. document: the
    same for a program.
    """

    name: str
    met: bool
    what: str
    details: tuple[str, ...]
    document: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one `expect` statement.

    line, column: where it stands. text: as written, on one line. cases: one for each demonstration that it speaks
    of. diagnostics: why it could not be run.
    """

    line: int
    column: int
    text: str
    cases: tuple[Case, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def result(self) -> Literal["met", "not met", "not run"]:
        """Return what came of it in one word."""
        if self.diagnostics:
            return "not run"
        return "met" if all(case.met for case in self.cases) else "not met"

    def to_json(self) -> dict[str, Any]:
        """Return the entry of the `stlspec.test/1` document."""
        return {
            "line": self.line,
            "column": self.column,
            "text": self.text,
            "result": self.result,
            "cases": [{"demonstration": c.name, "met": c.met, "what": c.what, **c.document} for c in self.cases],
            "diagnostics": [problem.to_json() for problem in self.diagnostics],
        }


@dataclass(frozen=True, slots=True)
class SpecTests:
    """A compiled spec with the `expect` statements of its text."""

    path: str
    syntax: Syntax
    bundle: BundleData
    statements: tuple[ExpectStatement, ...]


def load_tests(path: str | Path, params: Mapping[str, float | str] | None = None) -> SpecTests:
    """Compile a spec file and find its `expect` statements.

    Not in the paper: tests of specs.

    Raises: SpecError: the spec has errors. InputError: it cannot be used. UsageError: it is a bundle.
    """
    data = files.read_bytes(path, bundle_file.LARGEST)
    if files.looks_like_bundle(path, data):
        raise UsageError([diagnostic("B706", file=str(path))])
    syntax = parse_with_uses(files.decode(data, str(path)), files.read_used)
    bundle = compile_syntax(syntax, params)
    expected = VerdictExpectation | LabelExpectation | RankExpectation
    return SpecTests(str(path), syntax, bundle, tuple(s for s in syntax.statements if isinstance(s, expected)))


def run_tests(tests: SpecTests, environment: Environment | None = None) -> Iterator[Outcome]:
    """Run every `expect` statement of a spec, in the order of the text.

    Not in the paper: tests of specs.

    Args:    environment: computes missing signals from states, for demonstrations that name none.
    Returns: outcomes, each as soon as it is known. What cannot be run stops no other.
    """
    runner = _Runner(tests, environment)
    source = tests.syntax.source
    for statement in tests.statements:
        place = source.position(statement.span.start)
        text = " ".join(source.slice(statement.span).split())
        try:
            yield Outcome(place.line, place.column, text, runner.cases(statement))
        except InputError as error:
            yield Outcome(place.line, place.column, text, diagnostics=error.diagnostics)


class _Runner:
    """The data and the partial specs of one run; files are read once."""

    def __init__(self, tests: SpecTests, environment: Environment | None) -> None:
        self._tests = tests
        self._environment = environment
        self._alone: dict[str, BundleData] = {}
        self._load = lru_cache(_FILES_KEPT)(load_demonstrations)

    def cases(self, statement: ExpectStatement) -> tuple[Case, ...]:
        """Return what each demonstration shows. Raises: InputError: the data cannot be used."""
        match statement:
            case VerdictExpectation():
                return tuple(self._verdict(statement, d) for d in self._data(statement.data))
            case LabelExpectation(_, data, label):
                ranking = self._ranked(self._data(data))
                return tuple(_label_case(row, label.text) for row in ranking.demonstrations)
            case RankExpectation(_, better, worse):
                return self._rank(self._data(better), self._data(worse))

    def _verdict(self, statement: VerdictExpectation, demonstration: Demonstration) -> Case:
        name = statement.requirement.text
        if name not in self._alone:
            self._alone[name] = only(self._tests.bundle, name)
        bundle, at = self._alone[name], int(statement.at.value) if statement.at is not None else 0
        if isinstance(statement.data, InlineData):
            # Its columns are signals, whatever columns of a file they are read from elsewhere.
            bundle = replace(bundle, signals=tuple(replace(signal, source=None) for signal in bundle.signals))
        bound = bind(bundle, demonstration, self._environment)
        file = demonstration.file or demonstration.name
        result = evaluate_ending(bundle, bound.signals, bound.time, at=at, file=file)[name]
        wanted, least = _VERDICTS[statement.verdict.text], statement.margin.value if statement.margin else 0.0
        met = result.verdict is wanted and abs(result.robustness) >= least
        said, document = _verdict_text(name, result, wanted, least), _verdict_document(result)
        if met:
            return Case(demonstration.name, True, said, (), document)
        explanation = explain(bundle, name, result)
        document["explanation"] = explanation.to_json()
        return Case(demonstration.name, False, said, tuple(_detail_lines(explanation)), document)

    def _rank(self, better: Sequence[Demonstration], worse: Sequence[Demonstration]) -> tuple[Case, ...]:
        rows = self._ranked([*better, *worse]).demonstrations
        best = max(rows[len(better) :], key=lambda row: row.rank or 0)
        return tuple(_rank_case(row, best) for row in rows[: len(better)])

    def _ranked(self, demonstrations: Sequence[Demonstration]) -> Ranking:
        bundle = self._tests.bundle
        return rank_demonstrations(bundle, evaluate_demonstrations(bundle, demonstrations, self._environment))

    def _data(self, data: DataFile | InlineData) -> tuple[Demonstration, ...]:
        """Return the demonstrations that an expectation speaks of."""
        if isinstance(data, InlineData):
            return (self._inline(data),)
        path = os.path.join(os.path.dirname(self._tests.path), data.path.text)  # noqa: PTH118, PTH120 - as shown
        found = self._load(path)
        if data.episode is None:
            return found
        wanted = number_text(data.episode.value) if isinstance(data.episode, Number) else data.episode.text
        by_name = [d for d in found if wanted in (d.recording.name, d.recording.episode)]
        if not by_name and isinstance(data.episode, Number) and data.episode.value < len(found):
            by_name = [found[int(data.episode.value)]]
        if by_name:
            return tuple(by_name)
        names = [d.recording.name or d.recording.episode or str(i) for i, d in enumerate(found)]
        way = f"it has {', '.join(names[:5])}" + (" and others" if names[5:] else "")
        raise UsageError([diagnostic("D880", file=path, what=f"the file has no episode {wanted}", help=way)])

    def _inline(self, data: InlineData) -> Demonstration:
        columns = {c.name.text: [sample.value for sample in c.samples] for c in data.columns}
        is_signal = any(signal.name == TIME for signal in self._tests.bundle.signals)
        time = None if is_signal else columns.pop(TIME, None)
        line = self._tests.syntax.source.position(data.span.start).line
        return make_demonstration(f"{self._tests.path}:{line}", columns, time=time)


def only(bundle: BundleData, name: str) -> BundleData:
    """Return the spec with one requirement alone, so that data need not have what others use.

    Not in the paper: tests of specs.
    """
    requirement = next(r for r in bundle.requirements if r.name == name)
    nodes, index = reachable(bundle.nodes, [requirement.root])
    return replace(
        bundle,
        requirements=(replace(requirement, root=index[requirement.root], depends_on=()),),
        nodes=nodes,
        names=MappingProxyType({let: index[root] for let, root in bundle.names.items() if root in index}),
        raw_weights=(1,),
        weights=(1.0,),
    )


def _verdict_text(name: str, result: RequirementResult, wanted: Verdict, least: float) -> str:
    """Say how a requirement came out, and what was expected of it where that is not so."""
    found = "holds" if result.verdict is Verdict.SATISFIED else "fails"
    margin = abs(result.robustness)
    said = f"{name} {found} with margin {_short(margin)}"
    if result.vacuous:
        said += ", vacuously: no sample lies in its window"
    if result.verdict is not wanted:
        return said + f", and was expected to {'hold' if wanted is Verdict.SATISFIED else 'fail'}"
    return said + (f", less than {_short(least)}" if margin < least else "")


def _detail_lines(explanation: Explanation) -> Iterator[str]:
    """Yield where a value is decided, and the sub-formulas and signals there."""
    yield from (line.strip() for line in explanation.lines()[1:] if not line.strip().startswith("by way of"))
    texts = [step.text if step.name is None else f"{step.name}: {step.text}" for step in explanation.steps]
    width = max(map(len, texts))
    for step, text in zip(explanation.steps, texts, strict=True):
        at = f"sample {step.sample}" + ("" if explanation.unit == "step" else f" ({step.time:g} {explanation.unit})")
        yield f"    {text:<{width}}  {_short(step.robustness):>8} at {at}"
    for name, value in explanation.signals.items():
        shown = str(value).lower() if isinstance(value, bool) else _short(value)
        yield f"    {name:<{width}}  {shown:>8} there"


def _verdict_document(result: RequirementResult) -> dict[str, Any]:
    witness = result.witness
    return {
        "verdict": result.verdict.value,
        "robustness": number(result.robustness),
        "margin": number(abs(result.robustness)),
        "vacuous": result.vacuous,
        "witness": None if witness is None else {"sample": witness.sample, "time": witness.time},
    }


def _label_case(row: DemonstrationScore, wanted: str) -> Case:
    reasons = tuple(score.reason for score in row.requirements.values() if score.reason)
    document = {"label": row.label, "reasons": list(reasons)}
    said = f"it is {row.label}" + ("" if row.label == wanted else f", and was expected to be {wanted}")
    return Case(row.name, row.label == wanted, said, reasons, document)


def _rank_case(row: DemonstrationScore, best: DemonstrationScore) -> Case:
    met = (row.rank or 0) > (best.rank or 0)
    relation = "outranks" if met else "ranks with" if row.rank == best.rank else "ranks below"
    details = tuple(f"{r.name}: {r.label}, reward {_short(r.reward or 0.0)}" for r in (row, best))
    document = {"label": row.label, "reward": row.reward, "other": best.name}
    document |= {"other_label": best.label, "other_reward": best.reward}
    return Case(row.name, met, f"{row.name} {relation} {best.name}", details, document)


def _short(value: float) -> str:
    return f"{value + 0.0:.6g}"
