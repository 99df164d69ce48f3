"""The conformance vectors hold through the whole front end: text, compiler, evaluation."""

import json
from pathlib import Path

import pytest

from stlspec import api
from stlspec.errors import DataError, SpecError

VECTORS = json.loads((Path(__file__).parent / "vectors.json").read_text())["vectors"]
WORDS = {
    "G": ("always", "G"), "F": ("eventually", "F"), "H": ("historically", "H"), "O": ("once", "O"),
    "U": ("until", "U"), "S": ("since", "S"), "R": ("release", "R"), "W": ("unless", "W"),
    "next": ("next", "X"), "prev": ("prev", "Y"), "not": ("not", "!"), "and": ("and", "&&"), "or": ("or", "||"),
    "implies": ("implies", "->"), "iff": ("iff", "<->"), "xor": ("xor", "xor"),
}  # fmt: skip


def render(formula, unit, style):
    """Write a nested list as text of the language; style 0 is canonical, 1 the aliases."""
    op, *rest = formula
    if op == "pred":
        signal, comparison, constant = rest
        return f"{signal} {comparison} {constant}"
    if op == "bool":
        return rest[0]
    word = WORDS[op][style]
    if op in "GFHOUSRW":
        bounds = rest.pop(0)
        if bounds is not None:
            word += f"[{', '.join(f'{b} {unit}' if b != 'inf' else b for b in bounds)}]"
    parts = [f"({render(part, unit, style)})" for part in rest]
    return f"{word} {parts[0]}" if len(parts) == 1 else f"{parts[0]} {word} {parts[1]}"


def whole(formula):
    """Tell whether all bounds of a nested list are whole numbers."""
    return all(
        whole(part) if isinstance(part[0], str) else all(b == "inf" or b == int(b) for b in part)
        for part in formula
        if isinstance(part, list)
    )


def spec_of(vector, style):
    """The text of a vector, and its time stamps where samples are not simply counted."""
    trace = vector["trace"]
    # A bound between two samples that are counted is refused or warned of, so such a vector takes stamps.
    counted = style == 0 and trace["t"] == list(range(len(trace["t"]))) and whole(vector["formula"])
    formula = render(vector["formula"], "step" if counted else "s", style)
    text = f"time {'step' if counted else 's'}\nsignal x\nsignal y\nsignal b: bool\nhard a: {formula}\n"
    return text, None if counted else trace["t"]


@pytest.mark.parametrize("style", [0, 1])
@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: v["id"])
def test_a_vector_has_its_value_and_its_verdict(vector, style):
    text, time = spec_of(vector, style)
    signals = {
        name: [bool(x) if name == "b" else float(x) for x in values]
        for name, values in vector["trace"].items()
        if name != "t"
    }
    expected = vector["expected"]
    if isinstance(expected, str) and expected.startswith("error:"):
        with pytest.raises((SpecError, DataError)) as caught:
            api.compile(text).evaluate(signals, time=time, at=vector["at"])
        wanted = "I4" if expected == "error:interval" else "D801"
        assert [d.code.startswith(wanted) for d in caught.value.diagnostics] == [True]
        return
    result = api.compile(text).evaluate(signals, time=time, at=vector["at"])["a"]
    assert result.robustness == float(expected)
    assert result.verdict == vector["verdict"]


def test_all_vectors_are_there():
    assert len(VECTORS) == 116
    assert sum(str(v["expected"]).startswith("error:") for v in VECTORS) == 5
