"""How a foreign spec becomes statements: legal names, units of bounds, what is a let."""

import pytest

from stlspec.errors import SpecError, UsageError, diagnostic
from stlspec.lang.nodes import LetStatement, RequirementStatement
from stlspec.source import SourceText, Span
from stlspec.tools.importing.breach import read
from stlspec.tools.importing.model import Draft, refuse_broken, time_statement


def draft():
    return Draft(SourceText.of("f", ""), "Tool", time_statement("s"))


def test_names_become_legal_ones_and_stay_apart():
    found = draft()
    names = ["a.b", "a_b", "a/b", "always", "9x", "$x", "time", "plain"]
    legal = [found.legal(name) for name in names]
    assert legal == ["a_b", "a_b_", "a_b__", "always_", "_9x", "_x", "time_", "plain"]
    assert [found.legal(name) for name in names] == legal


def test_a_signal_with_another_name_is_read_from_its_own_column():
    found = draft()
    found.signal("a.b", Span(0, 3))
    found.signal("a.b", Span(5, 8))
    (signal,) = found.signals.values()
    assert (signal.name.text, signal.source.text, signal.span) == ("a_b", "a.b", Span(0, 3))


@pytest.mark.parametrize("text", ["step", "s", "100 ms"])
def test_time_is_given_as_in_a_spec(text):
    statement = time_statement(text)
    assert (f"{statement.number:g} " if statement.number else "") + statement.unit.text == text


@pytest.mark.parametrize("text", ["", "soon", "5", "s\nsignal x", "0 s", "furlong"])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(UsageError):
        time_statement(text)


def test_formulas_that_others_use_are_lets_wherever_they_stand():
    statements = read(SourceText.of("f", "b := ev a\na := x[t] > 0\nc := alw b"), "step").statements()
    kinds = {s.name.text: type(s) for s in statements if isinstance(s, LetStatement | RequirementStatement)}
    assert kinds == {"b": LetStatement, "a": LetStatement, "c": RequirementStatement}


def test_warnings_pass_and_errors_do_not():
    source = SourceText.of("f", "x")
    warning = diagnostic("S042", source=source, span=Span(0, 1), what="w", help="h")
    refuse_broken([warning])
    with pytest.raises(SpecError):
        refuse_broken([warning, diagnostic("S043", source=source, span=Span(0, 1), what="w", help="h")])
