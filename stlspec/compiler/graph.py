"""The DAG of requirements as a graph object and as pictures in text.

In: a bundle. Out: a networkx graph, a tree for the terminal, Mermaid or DOT. networkx is heavy, so it is
imported by the functions that use it, here and nowhere else.
"""

from typing import TYPE_CHECKING

from stlspec.compiler.bundle import BundleData

if TYPE_CHECKING:
    import networkx as nx


def to_networkx(bundle: BundleData) -> "nx.DiGraph":
    """Return the DAG, edges from prerequisite to dependant; nodes carry strength, weight, raw_weight, doc."""
    import networkx as nx

    graph = nx.DiGraph(name=bundle.name)
    rows = zip(bundle.requirements, bundle.weights, bundle.raw_weights, strict=True)
    for requirement, weight, raw in rows:
        graph.add_node(
            requirement.name,
            strength=requirement.strength,
            weight=weight,
            raw_weight=raw,
            doc=requirement.doc,
        )
    graph.add_edges_from(bundle.edges)
    return graph


def _reduced(bundle: BundleData) -> "nx.DiGraph":
    """Return the DAG without the edges that a longer path says already."""
    import networkx as nx

    graph = to_networkx(bundle)
    reduced = nx.transitive_reduction(graph)
    ordered = nx.DiGraph()
    ordered.add_nodes_from(graph.nodes(data=True))
    ordered.add_edges_from(sorted(reduced.edges, key=lambda e: [*map(list(graph).index, e)]))
    return ordered


def _weight_text(raw: int, weight: float) -> str:
    return f"{raw} → {weight:.3f}"


def tree_text(bundle: BundleData) -> str:
    """Draw the transitive reduction as a tree, each requirement with raw and softmax weight."""
    import networkx as nx

    graph = _reduced(bundle)
    for name, data in graph.nodes(data=True):
        data["label"] = f"{data['strength']} {name}   {_weight_text(data['raw_weight'], data['weight'])}"
    sources = [name for name in graph if not graph.in_degree(name)]
    return "\n".join(nx.generate_network_text(graph, sources=sources, ascii_only=False))


def mermaid_text(bundle: BundleData) -> str:
    """Draw the transitive reduction as a Mermaid flowchart."""
    graph = _reduced(bundle)
    lines = ["flowchart TD"]
    for name, data in graph.nodes(data=True):
        label = f"{data['strength']} {name}<br/>{_weight_text(data['raw_weight'], data['weight'])}"
        opening, closing = ('["', '"]') if data["strength"] == "hard" else ('("', '")')
        lines.append(f"    n_{name}{opening}{label}{closing}")
    lines += [f"    n_{before} --> n_{after}" for before, after in graph.edges]
    return "\n".join(lines)


def dot_text(bundle: BundleData) -> str:
    """Draw the transitive reduction in the DOT language."""
    graph = _reduced(bundle)
    lines = [f'digraph "{bundle.name or "spec"}" {{', "    node [fontname=sans];"]
    for name, data in graph.nodes(data=True):
        shape = "box" if data["strength"] == "hard" else "ellipse"
        label = f"{data['strength']} {name}\\n{_weight_text(data['raw_weight'], data['weight'])}"
        lines.append(f'    "{name}" [shape={shape}, label="{label}"];')
    lines += [f'    "{before}" -> "{after}";' for before, after in graph.edges]
    return "\n".join([*lines, "}"])
