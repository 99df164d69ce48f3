"""Diagnostics as people and programs see them, and the exceptions that carry them."""

import pickle

import pytest

from stlspec.errors import (
    BundleError,
    DataError,
    Edit,
    InputError,
    Label,
    SpecError,
    StlspecError,
    UsageError,
    diagnostic,
    render,
)
from stlspec.source import SourceText, Span

SOURCE = SourceText.of("grid.stl", "signal d\nhard a: always[3 s, 1 s] (d > 1)\n")
REVERSED = diagnostic("I401", source=SOURCE, span=Span(23, 33), low="3 s", high="1 s")


def test_a_diagnostic_is_drawn_with_place_excerpt_carets_and_help():
    assert render(REVERSED).split("\n") == [
        "error[I401]: the interval ends before it begins",
        "  --> grid.stl:2:15",
        "   2 | hard a: always[3 s, 1 s] (d > 1)",
        "     |               ^^^^^^^^^^ 3 s comes after 1 s",
        "     = help: write [1 s, 3 s]",
    ]


def test_a_second_place_is_drawn_too():
    label = Label(Span(7, 8), "declared here", SOURCE)
    drawn = render(diagnostic("N102", source=SOURCE, span=Span(14, 15), labels=(label,), name="a")).split("\n")
    assert drawn[4:7] == ["  --> grid.stl:1:8", "   1 | signal d", "     |        ^ declared here"]


def test_without_a_place_the_file_is_named():
    drawn = render(diagnostic("S092", file="x.stl", verb="read", problem="permission denied", help="ask"))
    assert drawn.split("\n") == [
        "error[S092]: cannot read this file: permission denied",
        "  --> x.stl",
        "     = help: ask",
    ]


def test_painting_sees_every_piece_with_its_role():
    roles = []
    render(REVERSED, lambda text, role: roles.append(role) or text)
    assert roles == ["error", "place", "error", "help"]


def test_json_has_lines_and_columns_from_one_and_nulls_where_unknown():
    assert REVERSED.to_json() == {
        "code": "I401",
        "severity": "error",
        "message": "the interval ends before it begins",
        "file": "grid.stl",
        "line": 2,
        "column": 15,
        "end_line": 2,
        "end_column": 25,
        "help": "write [1 s, 3 s]",
        "labels": [],
        "fixes": [],
    }
    nowhere = diagnostic("G506").to_json()
    assert (nowhere["file"], nowhere["line"], nowhere["end_column"]) == (None, None, None)


def test_a_fix_makes_all_its_edits_and_shows_them_with_places():
    span = Span(14, 15)
    edits = (Edit(Span(7, 8), "e"), Edit(Span(8, 8), " in"), Edit(span, ""))
    found = diagnostic("N102", source=SOURCE, span=span, edits=edits, name="a")
    (fix,) = found.fixes
    assert fix.title == found.help
    assert fix.applied("signal d\nhard d") == "signal e in\nhard "
    (shown,) = found.to_json()["fixes"]
    assert shown["edits"][0] == {"line": 1, "column": 8, "end_line": 1, "end_column": 9, "text": "e"}


def test_diagnostics_sort_by_file_then_place_then_code():
    late = diagnostic("S019", source=SOURCE, span=Span(30, 31), bracket=")")
    early = diagnostic("S011", source=SOURCE, span=Span(2, 3), word="signal")
    other = diagnostic("S016", source=SourceText.of("a.stl", ""), span=Span(0, 0))
    assert sorted([late, early, other], key=lambda d: d.sort_key()) == [other, early, late]


@pytest.mark.parametrize(
    ("kind", "code", "parent"),
    [
        (SpecError, 1, StlspecError),
        (InputError, 2, StlspecError),
        (BundleError, 2, InputError),
        (DataError, 2, InputError),
        (UsageError, 2, InputError),
    ],
)
def test_every_exception_carries_its_diagnostics_and_exit_code(kind, code, parent):
    error = kind(iter([REVERSED]))
    assert isinstance(error, parent)
    assert (error.exit_code, error.diagnostics) == (code, (REVERSED,))
    assert "error[I401]" in str(error)


def test_an_error_travels_between_processes() -> None:
    for kind in (StlspecError, SpecError, BundleError, DataError, UsageError):
        error = kind([diagnostic("D863", file="R.json", problem="empty")])
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is kind
        assert (again.diagnostics, str(again)) == (error.diagnostics, str(error))
