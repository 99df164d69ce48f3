"""Vectors are read strictly, written out as text, and run through the whole compiler."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from stlspec.errors import DataError
from stlspec.tools.conformance import DEEPEST, LARGEST, SCHEMA, formula_text, load_vectors, run_vector

VECTORS = Path(__file__).parents[1] / "conformance" / "vectors.json"
P, Q = ["pred", "x", ">=", 1], ["pred", "y", "<", -0.5]
GOOD: dict[str, Any] = {
    "id": "a",
    "formula": ["G", [0, 1], P],
    "trace": {"t": [0, 1, 2], "x": [3, 1, "-inf"]},
    "at": 0,
    "expected": 0,
    "verdict": "satisfied",
}


def write(path: Path, *vectors: Any) -> Path:
    path.write_text(json.dumps({"meta": {"schema": SCHEMA}, "vectors": list(vectors)}))
    return path


def outcome(tmp_path: Path, **changes: Any) -> Any:
    (vector,) = load_vectors(write(tmp_path / "v.json", {**GOOD, **changes}))
    return run_vector(vector)


@pytest.mark.parametrize("vector", load_vectors(VECTORS), ids=lambda v: v.id)
def test_every_vector_of_the_project_holds(vector: Any) -> None:
    result = run_vector(vector)
    assert result.holds, result


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (P, "x >= 1"),
        (["pred", "x", "!=", "-inf"], "x != -inf"),
        (["bool", "b"], "b"),
        (["not", P], "not (x >= 1)"),
        (["prev", ["next", P]], "prev (next (x >= 1))"),
        (["xor", P, Q], "(x >= 1) xor (y < -0.5)"),
        (["G", None, P], "always (x >= 1)"),
        (["O", [0.5, "inf"], P], "once[0.5 s, inf] (x >= 1)"),
        (["W", [1, 2], P, Q], "(x >= 1) unless[1 s, 2 s] (y < -0.5)"),
        (["R", None, P, Q], "(x >= 1) release (y < -0.5)"),
    ],
)
def test_formulas_are_written_with_every_operand_in_parentheses(formula: Any, text: str) -> None:
    assert formula_text(formula) == text


@pytest.mark.parametrize(
    "changes",
    [{"expected": 0.5}, {"expected": "inf"}, {"verdict": "violated"}, {"expected": "error:nan", "verdict": None}],
)
def test_a_wrong_value_verdict_or_missing_error_does_not_hold(tmp_path: Path, changes: dict[str, Any]) -> None:
    assert outcome(tmp_path).holds
    assert not outcome(tmp_path, **changes).holds


def test_only_the_expected_kind_of_error_holds(tmp_path: Path) -> None:
    reversed_interval = outcome(tmp_path, formula=["G", [2, 1], P], expected="error:interval", verdict=None)
    assert reversed_interval.codes == ("I401",)
    assert reversed_interval.holds
    assert not outcome(tmp_path, formula=["G", [2, 1], P], expected="error:nan", verdict=None).holds
    assert outcome(tmp_path, trace={"t": [0], "x": ["nan"]}, expected="error:nan", verdict=None).holds


@pytest.mark.parametrize(
    "changes",
    [
        {"formula": ["G", [0, 1], ["pred", "always", ">=", 1]], "trace": {"t": [0], "always": [1]}},
        {"trace": {"t": [0, 1], "x": [1]}},
        {"trace": {"t": [1, 0], "x": [1, 1]}},
        {"trace": {"t": [], "x": []}},
        {"trace": {"t": [0], "y": [1]}},
        {"at": 7},
    ],
)
def test_a_vector_that_cannot_be_evaluated_fails_and_does_not_stop_the_run(
    tmp_path: Path, changes: dict[str, Any]
) -> None:
    result = outcome(tmp_path, **changes)
    assert result.robustness is None
    assert result.codes
    assert result.message
    assert not result.holds


def nested(depth: int) -> Any:
    formula: Any = P
    for _ in range(depth):
        formula = ["not", formula]
    return formula


@pytest.mark.parametrize(
    "changes",
    [
        {"formula": None},
        {"formula": []},
        {"formula": "G"},
        {"formula": ["G", P]},
        {"formula": ["G", [1], P]},
        {"formula": ["G", [0, math.nan], P]},
        {"formula": ["G", [0, 10**400], P]},
        {"formula": ["pred", "x", "=", 1]},
        {"formula": ["pred", "x", ">=", "nan"]},
        {"formula": ["pred", "x", ">=", True]},
        {"formula": ["pred", "x >= 1\nhard other: x", ">=", 1]},
        {"formula": ["bool", ["x"]]},
        {"formula": nested(DEEPEST + 1)},
        {"trace": {"x": [1]}},
        {"trace": {"t": [0], "x y": [1]}},
        {"trace": {"t": [0], "x": 1}},
        {"trace": {"t": [0], "x": [None]}},
        {"at": "0"},
        {"at": True},
        {"at": 10**30},
        {"expected": None},
        {"expected": "error:other"},
        {"expected": math.nan},
        {"verdict": "true"},
    ],
    ids=str,
)
def test_what_is_no_vector_is_refused_with_its_place(tmp_path: Path, changes: dict[str, Any]) -> None:
    with pytest.raises(DataError) as caught:
        load_vectors(write(tmp_path / "v.json", GOOD, {**GOOD, "id": "bad", **changes}))
    (found,) = caught.value.diagnostics
    assert found.code == "D880"
    assert found.message.startswith("vector 1 (id 'bad'): ")
    assert len(found.message) < 200


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "D833"),
        (b"{", "D836"),
        (b"[" * 100_000, "D836"),
        (b"\xff", "D880"),
        (b"[]", "D880"),
        (b'{"vectors": []}', "D880"),
        (b'{"meta": {"schema": "stlspec.conformance/1"}, "vectors": []}', "D880"),
        (b'{"meta": {"schema": "stlspec.conformance/1"}, "vectors": [3]}', "D880"),
        (b'{"a": 1, "a": 2}', "D835"),
    ],
)
def test_other_files_are_refused_with_one_diagnostic(tmp_path: Path, content: bytes, code: str) -> None:
    file = tmp_path / "v.json"
    file.write_bytes(content)
    with pytest.raises(DataError) as caught:
        load_vectors(file)
    assert [d.code for d in caught.value.diagnostics] == [code]


def test_a_missing_or_oversized_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="D830"):
        load_vectors(tmp_path / "none.json")
    large = tmp_path / "large.json"
    with large.open("wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(DataError, match="D838"):
        load_vectors(large)
