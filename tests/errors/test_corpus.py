"""Rejected specs: the expected diagnostic stands on the line that it is about, and there is no other."""

import re
from pathlib import Path

import pytest

from stlspec.compiler.review import review_source
from stlspec.source import SourceText

CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("*.stl"))
EXPECTED = re.compile(r"""# (error|warning) ([A-Z]\d{3}) (?:"(.*?)"|'(.*?)')(?=\s|$)""")
FIRST_NINE = (
    "missing_square_bracket missing_round_bracket misspelt_operator misspelt_signal dangling_and reversed_interval "
    "equals_for_comparison missing_unit depends_on_nothing"
).split()
ALSO_CLEANED = (
    "missing_square_bracket_after_a_param missing_square_bracket_before_a_name wrong_case open_intervals".split()
)


def read(name):
    path = Path(__file__).parents[1] / "corpus" / f"{name}.stl"
    return path.read_text(encoding="utf-8")


def found_in(text):
    return review_source(SourceText.of("corpus.stl", text)).diagnostics


@pytest.mark.parametrize("path", CORPUS, ids=lambda p: p.stem)
def test_each_rejected_line_gives_its_diagnostic_and_no_other_line_gives_one(path):
    text = path.read_text(encoding="utf-8")
    expected = [
        (number, severity, code, part or quoted)
        for number, line in enumerate(text.split("\n"), 1)
        for severity, code, part, quoted in EXPECTED.findall(line)
    ]
    found = [(d.source.position(d.span.start).line, d.severity, d.code, d.message) for d in found_in(text)]
    assert [row[:3] for row in found] == [row[:3] for row in expected], found
    assert expected, "a corpus file expects something"
    for (*_, message), (*_, part) in zip(found, expected, strict=True):
        assert part in message


def follow(text, problem):
    """Do what the help says, literally."""
    help_, start, end = problem.help, problem.span.start, problem.span.end
    if match := re.fullmatch(r"write `(.+)` after `(.+)`", help_):
        at = text.rindex(match[2], 0, start + 1) + len(match[2])
        return text[:at] + match[1] + text[at:]
    if match := re.fullmatch(r"complete the statement here, or remove `(.+)`", help_):
        at = text.rindex(match[1], 0, start + 1)
        return text[:at] + text[at + len(match[1]) :]
    if match := re.match(r"remove `(.+?)`", help_):
        at = text.index(match[1])
        return text[:at].rstrip() + text[at + len(match[1]) :]
    match = re.match(r"did you mean `(.+)`\?$|write `(.+?)`( in place of .*)?$|write (\[.+\])$", help_)
    assert match, help_
    return text[:start] + (match[1] or match[2] or match[4]) + text[end:]


@pytest.mark.parametrize("name", FIRST_NINE + ALSO_CLEANED)
def test_following_the_help_literally_makes_the_file_clean(name):
    text = EXPECTED.sub("", read(name))
    for _ in range(5):
        problems = [problem for problem in found_in(text) if problem.code[0] != "L"]
        if not problems:
            return
        text = follow(text, problems[0])
    pytest.fail(f"still rejected: {text}")


def test_a_circle_is_shown_edge_by_edge_with_places():
    (problem,) = found_in(read("cycle"))
    assert problem.message.endswith("a -> b -> c -> a") or "circle" in problem.message
    edges = [problem.label, *(label.text for label in problem.labels)]
    assert edges == ["`a` depends on `b`", "`b` depends on `c`", "`c` depends on `a`"]
    places = [problem.span, *(label.span for label in problem.labels)]
    assert [problem.source.position(p.start).line for p in places] == [2, 3, 4]


def test_a_missing_bracket_shows_where_it_was_opened():
    (problem,) = found_in(read("missing_square_bracket"))
    (label,) = problem.labels
    assert problem.source.slice(label.span) == "["


def test_help_after_a_clause_that_stands_too_late_says_where_it_belongs():
    assert all("in front of the `:`" in problem.help for problem in found_in(read("clauses_after_the_formula")))
