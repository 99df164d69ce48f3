"""The DAG: distinct nodes once, operands first, numbered by meaning."""

from stlspec.compiler.ir import Builder, Node, reachable


def test_equal_nodes_are_one_and_zeros_of_both_signs_are_two():
    builder = Builder()
    x = builder.add("signal", value="x")
    assert builder.add("signal", value="x") == x
    assert builder.add("const", value=0.0) != builder.add("const", value=-0.0)
    assert builder.add("ge", [x, 1]) == builder.add("ge", [x, 1])
    assert builder.add("always", [x], interval=(0, 1)) != builder.add("always", [x], interval=(0, 2))


def test_only_what_is_needed_is_kept_in_the_order_of_a_walk_from_the_roots():
    builder = Builder()
    unused = builder.add("signal", value="unused")
    y, x = builder.add("signal", value="y"), builder.add("signal", value="x")
    less = builder.add("lt", [x, y])
    root = builder.add("and", [less, less])
    nodes, order = reachable(builder.nodes, [root])
    assert nodes == (Node("signal", value="x"), Node("signal", value="y"), Node("lt", (0, 1)), Node("and", (2, 2)))
    assert unused not in order and order[root] == 3


def test_a_chain_deeper_than_the_stack_is_walked():
    builder = Builder()
    last = builder.add("bool", value="b")
    for _ in range(50_000):
        last = builder.add("next", [last])
    nodes, order = reachable(builder.nodes, [last])
    assert len(nodes) == 50_001 and order[last] == 50_000
