"""Every word of the language has its meaning, and nothing else has one."""

from stlspec.compiler.checks import BOUNDINGS
from stlspec.compiler.compiling import check_source
from stlspec.compiler.expectations import LABELS
from stlspec.compiler.inference import FUNCTIONS
from stlspec.lang.automaton import _CLAUSES
from stlspec.lang.statements import RESERVED, STATEMENT_WORDS
from stlspec.lang.tree import OPERATORS
from stlspec.source import SourceText
from stlspec.tools.lsp import words


def test_the_tables_hold_exactly_the_words_of_the_language():
    assert set(words.STATEMENTS) == set(STATEMENT_WORDS)
    assert set(words.OPERATORS) == OPERATORS
    assert set(words.FUNCTIONS) == set(FUNCTIONS)
    assert set(words.CLAUSES) == set(_CLAUSES) - {"SPEC", "USE", "TIME"}
    assert set(words.VALUES) == {"real", "bool", *BOUNDINGS, *LABELS}
    assert {*words.STATEMENTS, *words.OPERATORS, *words.CONSTANTS} >= RESERVED


def test_the_form_of_an_operator_or_function_is_one_that_checks():
    for word in (*words.OPERATORS.values(), *words.FUNCTIONS.values()):
        form = word.form.replace(", ...", "")
        if form == "f = g":
            continue
        lead = "abs" if form.startswith(tuple(words.FUNCTIONS)) or form in ("f + g", "f - g", "f * g", "f / g") else ""
        lead = lead or ("abs" if form in ("f ** g", "-f") else "")
        formula = f"abs({form}) > 0" if lead else f"({form})"
        text = "signal p: bool\nsignal q: bool\nsignal f\nsignal g\nsignal x\nsignal y\nparam a = 1\nparam b = 2\n"
        result = check_source(SourceText.of("form.stl", f"{text}hard h: {formula}\n"))
        assert not result.errors, form
