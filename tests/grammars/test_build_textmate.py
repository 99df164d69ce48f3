"""The colours of editors know the words of the grammar, all of them and no others, and the engine agrees."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from grammars.build_textmate import TARGET, Words, text, textmate
from stlspec.lang import grammar
from stlspec.lang.grammar import grammar_text
from stlspec.lang.parse import tokens_of
from stlspec.lang.statements import TIME_UNITS
from stlspec.source import SourceText

ROOT = Path(__file__).parents[2]
EXTENSION = ROOT / "grammars" / "vscode"
SPECS = sorted((ROOT / "specs").glob("*.stl"))
WORD = re.compile(r'^[A-Z_]+(?:\.\d)?: "([A-Za-z_]+)"$', re.M)
ALTERNATIVES = re.compile(r"\(\??:?((?:[A-Za-z_]+\|)*[A-Za-z_]+)\)")
needs_engine = pytest.mark.skipif(
    shutil.which("node") is None or not (EXTENSION / "node_modules" / "vscode-textmate").exists(),
    reason="needs Node.js, and `npm install` in grammars/vscode",
)


def patterns_in(value):
    if isinstance(value, dict):
        yield from ((k, v) for k, v in value.items() if k in ("match", "begin", "end") and isinstance(v, str))
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from patterns_in(inner)


def words_in(document):
    groups = [words for _, pattern in patterns_in(document) for words in ALTERNATIVES.findall(pattern)]
    return {word for group in groups for word in group.split("|")}


def test_the_committed_grammar_is_the_one_that_the_lark_grammar_gives():
    assert TARGET.read_text(encoding="utf-8") == text(), "run `python grammars/build_textmate.py`"


def test_its_words_are_those_of_the_language_and_no_others():
    words = set(WORD.findall(grammar_text()))
    assert len(words) > 60
    assert words_in(textmate()) - {*TIME_UNITS, "step"} == words - {"step"}


def test_every_sign_of_an_operator_is_coloured():
    signs = set(re.findall(r'^[A-Z_]+: "([^A-Za-z_]+)"$', grammar_text(), re.M)) - set("()[]{},:") - {":="}
    assert set(Words(grammar.build()).signs()) == signs


def test_a_word_that_is_new_in_the_language_is_new_there(monkeypatch):
    changed = grammar_text().replace("always: ALWAYS |", "always: ALWAYS | EVERMORE |") + '\nEVERMORE: "evermore"\n'
    monkeypatch.setattr(grammar, "grammar_text", lambda: changed)
    assert "evermore" in words_in(textmate())


def test_every_pattern_is_a_regular_expression():
    for _, pattern in patterns_in(textmate()):
        re.compile(pattern)


def test_the_extension_names_files_that_exist_and_the_languages_files():
    package = json.loads((EXTENSION / "package.json").read_text())
    (language,), (colours,) = package["contributes"]["languages"], package["contributes"]["grammars"]
    assert language["extensions"] == [".stl", ".stlspec"] and language["id"] == colours["language"]
    assert colours["scopeName"] == textmate()["scopeName"]
    assert EXTENSION / colours["path"] == TARGET
    for path in (package["main"], language["configuration"]):
        assert (EXTENSION / path).is_file()
    json.loads((EXTENSION / language["configuration"]).read_text())


def engine(*paths):
    """Return what the TextMate engine of VS Code makes of files: {(line, column): (text, scope)} for each."""
    command = ["node", str(EXTENSION / "test" / "tokens.mjs"), *map(str, paths)]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return [{(line, column): (text, scope) for line, column, text, scope in found[str(path)]} for path in paths]


def scopes(tmp_path, line, before=""):
    """Return the scopes of the words of one line, the common ends left out."""
    path = tmp_path / "a.stl"
    path.write_text(f"{before}{line}\n", encoding="utf-8")
    last = before.count("\n") + 1
    tokens = [token for (number, _), token in engine(path)[0].items() if number == last]
    return {text.strip(): scope.removesuffix(".stlspec") for text, scope in tokens}


SURE = {
    **dict.fromkeys("SIGNAL PARAM LET HARD SOFT EXPECT".split(), "keyword.control"),
    **dict.fromkeys("ALWAYS EVENTUALLY HISTORICALLY ONCE UNTIL SINCE UNLESS NEXT WNEXT".split(), "operator.temporal"),
    **dict.fromkeys("NOT AND OR IMPLIES IFF XOR".split(), "operator.logical"),
    **dict.fromkeys("TRUE FALSE INF".split(), "constant.language"),
    **dict.fromkeys("LE LT GE GT EQ NE ASSIGN PLUS MINUS STAR SLASH POWER ARROW".split(), "keyword.operator"),
    "NUMBER": "constant.numeric",
    "STRING": "string.quoted",
}
"""What a token must look like wherever it stands; contextual words depend on their neighbours."""


@needs_engine
def test_the_engine_sees_what_the_lexer_sees_in_every_spec():
    checked = 0
    for path, coloured in zip(SPECS, engine(*SPECS), strict=True):
        for token in tokens_of(SourceText.of(path.name, path.read_text(encoding="utf-8"))):
            if token.type in SURE:
                found = coloured[token.line, token.column]
                assert found[0] == str(token) and SURE[token.type] in found[1], (path.name, token.line, token, found)
                checked += 1
        assert not any("invalid" in scope for _, scope in coloured.values())
    assert checked > 250


@needs_engine
@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("soft fast depends on avoid scale 2 bound tanh: x > 2", {"depends": "clause", "bound": "clause", "2": "num"}),
        ("let a = depends > 1 and unit < at", {"depends": "variable", "unit": "variable", "at": "variable"}),
        ("let a = G[0, 5 s] (x > 3 m/s)", {"G": "temporal.alias", "s": "unit", "m/s": "unit"}),
        ("let a = G > 3 and S < 2", {"G": "variable", "S": "variable"}),
        ("let a = p U q", {"U": "temporal.alias", "p": "variable", "q": "variable"}),
        ("let a = x > S - 3", {"S": "variable"}),
        ("let a = rate(v) > 5 and dead_time < x", {"rate": "function", "and": "logical", "dead_time": "variable"}),
        ('use "a.stl"', {"use": "control"}),
        ("let a = use > time", {"use": "variable", "time": "variable"}),
        ("time 100 ms", {"time": "control", "100": "numeric", "ms": "unit"}),
        ('signal v: bool unit "m/s" in [0, 5] from "a"', {"v": "entity", "bool": "type", "unit": "clause"}),
        ('signal v "never closed', {'"never closed': "invalid.illegal"}),
        ("phi := x", {":=": "invalid.illegal"}),
        ("hard a: x  # stlspec: ignore L603", {"# stlspec: ignore L603": "directive"}),
    ],
)
def test_words_are_coloured_by_where_they_stand(tmp_path, line, expected):
    found = scopes(tmp_path, line)
    for word, scope in expected.items():
        assert scope in found[word], found


@needs_engine
@pytest.mark.parametrize("broken", ["hard a depends on b", 'signal x unit "m" in [0', "expect a fails on {x: [1"])
def test_a_broken_header_does_not_run_into_the_next_statement(tmp_path, broken):
    found = scopes(tmp_path, "let at = unit > on", before=f"{broken}\n\n")
    assert found["let"] == "keyword.control" and found["unit"] == found["on"] == "variable.other"
