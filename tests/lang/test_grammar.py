"""The grammar has no conflict, and its saved table is a cache that can be missing, stale or damaged."""

import pytest

from stlspec.lang import grammar
from stlspec.lang.tree import OPERATORS, TreeBuilder


@pytest.fixture
def table(tmp_path, monkeypatch):
    path = tmp_path / "table.bin"
    monkeypatch.setattr(grammar, "_TABLE", path)
    return path


def tree(parser, text):
    return parser.parse(text, start="statement")


TEXT = "hard a scale 2 depends on b: always[0, 5] (x + 1 > 2 ** -y) and not p implies q"


def test_the_grammar_has_no_conflict_even_in_strict_mode():
    pytest.importorskip("interegular")
    grammar.build(strict=True)


def test_every_operator_of_the_tree_is_a_rule_of_the_grammar():
    rules = {rule.origin.name for rule in grammar.build().rules}
    assert rules >= OPERATORS


def test_a_missing_table_is_rebuilt_in_memory_and_not_written(table):
    assert not grammar.table_is_current()
    assert tree(grammar.parser(TreeBuilder()), TEXT)
    assert not table.exists()


def test_a_saved_table_gives_the_same_trees(table):
    built = tree(grammar.parser(TreeBuilder()), TEXT)
    grammar.write_table()
    assert grammar.table_is_current()
    assert tree(grammar.parser(TreeBuilder()), TEXT) == built
    assert list(table.parent.iterdir()) == [table]


def test_a_table_of_another_grammar_is_not_used(table, monkeypatch):
    grammar.write_table()
    monkeypatch.setattr(grammar, "_key", lambda: b"0" * 64)
    assert not grammar.table_is_current()
    assert tree(grammar.parser(TreeBuilder()), TEXT)


@pytest.mark.parametrize(
    "damage", [lambda data: data[:64], lambda data: data[:2000], lambda data: data[:64] + b"x" * 99]
)
def test_a_damaged_table_is_rebuilt(table, damage):
    grammar.write_table()
    table.write_bytes(damage(table.read_bytes()))
    assert not grammar.table_is_current()
    assert tree(grammar.parser(TreeBuilder()), TEXT)


def test_the_grammar_is_found_beside_the_checkout_or_in_the_package():
    assert grammar.grammar_path().name == "stl.lark"
    assert "statement:" in grammar.grammar_text()
