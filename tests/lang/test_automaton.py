"""The loop over Lark's tables builds what Lark builds, and can be asked first."""

import random

from lark.exceptions import UnexpectedToken

from stlspec.lang.automaton import END, automaton
from stlspec.lang.parse import tokens_of
from stlspec.lang.statements import cut
from stlspec.source import SourceText
from tests.benchmarks.parsing import spec_of
from tests.lang.soup import soup


def walked(tokens):
    """How many tokens fit, and the node if all do and are a whole statement."""
    walk = automaton().walk("statement")
    for i, token in enumerate(tokens):
        fits = walk.accepts(token.type)
        assert walk.take(token) is fits
        if not fits:
            return i, None
    return len(tokens), walk.finish() if walk.accepts(END) else None


def by_lark(tokens):
    """The same from Lark's own loop."""
    state = automaton().lark.parse_interactive("", start="statement")
    for i, token in enumerate(tokens):
        try:
            state.feed_token(token)
        except UnexpectedToken:
            return i, None
    try:
        return len(tokens), state.feed_eof()
    except UnexpectedToken:
        return len(tokens), None


def statements():
    """Token lists: good statements, the same with a token lost, doubled or moved, and soup."""
    rng = random.Random(3)
    good = cut(SourceText.of("s", spec_of(100)), automaton().lark).statements
    yield from good
    for statement in good:
        tokens, i = list(statement), rng.randrange(len(statement))
        tokens[i : i + 1] = rng.choice([[], [tokens[i], tokens[i]], [tokens[-1]]])
        yield tokens
        yield tokens_of(SourceText.of("s", soup(rng)))


def test_a_walk_goes_as_far_as_lark_and_builds_the_same():
    whole = 0
    for tokens in statements():
        assert walked(tokens) == by_lark(tokens)
        whole += walked(tokens)[1] is not None
    assert whole >= 80


def test_asking_changes_nothing():
    tokens = tokens_of(SourceText.of("s", "let p = a and b < 2"))
    walk = automaton().walk("statement")
    for token in tokens:
        before = list(walk.states)
        assert not walk.accepts("COLON") and walk.accepts(END) in (True, False) and walk.expected()
        assert walk.states == before
        assert walk.take(token)


def test_what_is_expected_is_what_fits():
    walk = automaton().walk("statement")
    (word,) = tokens_of(SourceText.of("s", "param"))
    assert walk.take(word) and walk.expected() == {"NAME"}
    assert "NAME" in walk.row


def test_aliases_are_read_off_the_grammar():
    assert {"G", "ALW_", "X"} <= automaton().prefix_aliases
    assert {"U", "SINCE_", "R"} <= automaton().infix_aliases
    assert "UNTIL" not in automaton().contextual and "DEPENDS" in automaton().contextual
