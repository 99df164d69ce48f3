"""The DAG of requirements as a graph object and as pictures."""

import networkx as nx
import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.compiler.graph import dot_text, mermaid_text, to_networkx, tree_text
from stlspec.source import SourceText

BUNDLE = compile_source(
    SourceText.of(
        "s", 'spec grid\nsignal x\nhard a "first": x > 1\nsoft b depends on a: x > 2\nsoft c depends on a, b: x > 3'
    )
)


def test_the_graph_has_all_edges_and_the_weights_on_its_nodes():
    graph = to_networkx(BUNDLE)
    assert nx.is_directed_acyclic_graph(graph)
    assert set(graph.edges) == {("a", "b"), ("a", "c"), ("b", "c")}
    assert graph.nodes["a"]["weight"] == pytest.approx(0.6652409557748219, abs=1e-12)
    assert (graph.nodes["a"]["raw_weight"], graph.nodes["a"]["strength"], graph.nodes["a"]["doc"]) == (
        3,
        "hard",
        "first",
    )


def test_pictures_leave_out_what_a_longer_path_says_already():
    for text, edge, left_out in (
        (mermaid_text(BUNDLE), "n_b --> n_c", "n_a --> n_c"),
        (dot_text(BUNDLE), '"b" -> "c";', '"a" -> "c";'),
    ):
        assert edge in text and left_out not in text
    assert tree_text(BUNDLE).count("c   1") == 1


def test_pictures_show_strength_and_both_weights():
    assert "hard a   3 → 0.665" in tree_text(BUNDLE)
    assert 'n_a["hard a<br/>3 → 0.665"]' in mermaid_text(BUNDLE)
    assert 'n_b("soft b<br/>2 → 0.245")' in mermaid_text(BUNDLE)
    assert dot_text(BUNDLE).startswith('digraph "grid" {')
    assert '"a" [shape=box, label="hard a\\n3 → 0.665"];' in dot_text(BUNDLE)
