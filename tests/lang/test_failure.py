"""A failure points at the token that does not fit, or just behind the last one."""

import pytest
from lark import Token

from stlspec.lang.failure import Failure
from stlspec.lang.parse import tokens_of
from stlspec.source import SourceText, Span

SOURCE = SourceText.of("a.stl", "hard a: (x ( > 1")


def failure(at):
    return Failure(SOURCE, tokens_of(SOURCE), at, frozenset({"NAME"}), (), False, frozenset())


@pytest.mark.parametrize(("at", "text", "span"), [(6, ">", Span(13, 14)), (8, None, Span(16, 16))])
def test_it_points_at_its_token_or_behind_the_last(at, text, span):
    assert (failure(at).token, failure(at).span) == (text, span)
    assert failure(at).error("S019", bracket="(").span == span


def test_equal_brackets_are_told_apart():
    found = failure(0)
    brackets = [t for t in found.tokens if t.type == "LPAR"]
    assert [found.place(bracket) for bracket in brackets] == [3, 5]
    assert all(isinstance(bracket, Token) for bracket in brackets)
