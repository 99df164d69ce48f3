"""Formulas in the notation of each tool.

In: nested lists as in `tests/conformance/vectors.json`. Out: text. Every operand stands in parentheses, so
that no tool's precedence matters. A formula outside a tool's language raises KeyError: `fragments` makes none.
"""

from stlspec.compiler.ir import Builder, reachable
from stlspec.compiler.printing import number_text

_COMPARISONS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}


def rtamt(formula):
    """RTAMT; release is written as its dual, and `!=` is spelled `!==` there."""
    op, operands = formula[0], formula[1:]
    if op == "pred":
        signal, sign, bound = operands
        return f"{signal} {'!==' if sign == '!=' else sign} {number_text(bound)}"
    if op == "R":
        interval, left, right = operands
        return rtamt(["not", ["U", interval, ["not", left], ["not", right]]])
    words = {"G": "always", "F": "eventually", "H": "historically", "O": "once", "U": "until", "S": "since"}
    infix = {"and": "and", "or": "or", "implies": "->"}
    return _written(formula, rtamt, {**words, "W": "unless", "not": "not"}, infix, "[{},{}]")


def pybanquo(formula):
    """pybanquo; bounds stand in braces."""
    if formula[0] == "pred":
        _, signal, sign, bound = formula
        return f"{signal} {sign} {number_text(bound)}"
    words = {"G": "always", "F": "eventually", "next": "X", "not": "not"}
    return _written(formula, pybanquo, words, {"and": "and", "or": "or", "implies": "implies"}, "{{{},{}}}")


def reelay(formula):
    """Reelay; predicates stand in braces, an interval without end is `[a:]`."""
    op, operands = formula[0], formula[1:]
    if op == "pred":
        signal, sign, bound = operands
        return f"{{{signal} {sign} {number_text(bound)}}}"
    if op == "bool":
        return f"{{{operands[0]}: true}}"
    words = {"H": "historically", "O": "once", "S": "since", "not": "not", "prev": "pre"}
    return _written(formula, reelay, words, {"and": "and", "or": "or", "implies": "implies"}, "[{}:{}]")


def mstlo(formula):
    """mstlo; its until holds the left operand at t' too, so only p until (p and q) can be written there."""
    op, operands = formula[0], formula[1:]
    if op == "pred":
        signal, sign, bound = operands
        return f"{signal} {sign} {number_text(bound)}"
    if op == "U":
        interval, left, right = operands
        if right[:2] != ["and", left]:
            raise KeyError(op)
        return f"({mstlo(left)}) U[{interval[0]}, {interval[1]}] ({mstlo(right[2])})"
    return _written(
        formula, mstlo, {"G": "G", "F": "F", "not": "!"}, {"and": "and", "or": "or", "implies": "->"}, "[{}, {}]"
    )


def stlrom(formula):
    """STLRom; an operator without interval has no other spelling than a long one."""
    if formula[0] == "pred":
        _, signal, sign, bound = formula
        return f"{signal}[t] {sign} {number_text(bound)}"
    words = {"G": "alw_", "F": "ev_", "U": "until_", "not": "not"}
    return _written(formula, stlrom, words, {"and": "and", "or": "or", "implies": "=>"}, "[{}, {}]")


def moonlight(formula):
    """MoonLight; implication is spelled out, since `=>` means >= there."""
    if formula[0] == "pred":
        _, signal, sign, bound = formula
        return f"({signal} {sign} {number_text(bound)})"
    if formula[0] == "implies":
        return moonlight(["or", ["not", formula[1]], formula[2]])
    words = {"G": "globally", "F": "eventually", "U": "until", "not": "!"}
    return _written(formula, moonlight, words, {"and": "&", "or": "|"}, " [{}, {}]")


def stlspec(formula):
    """The language itself, bounds counting samples."""
    if formula[0] == "pred":
        _, signal, sign, bound = formula
        return f"{signal} {sign} {number_text(bound)}"
    words = {"G": "always", "F": "eventually", "U": "until", "not": "not"}
    past = {"H": "historically", "O": "once", "S": "since"}
    infix = {"and": "and", "or": "or", "implies": "implies"}
    return _written(formula, stlspec, words | past, infix, "[{}, {}]")


WRITERS = {
    "rtamt": rtamt,
    "pybanquo": pybanquo,
    "reelay": reelay,
    "mstlo": mstlo,
    "stlrom": stlrom,
    "moonlight": moonlight,
    "stlspec": stlspec,
}


def _written(formula, write, words, infix, brackets):
    op, operands = formula[0], formula[1:]
    if op in infix:
        left, right = operands
        return f"({write(left)}) {infix[op]} ({write(right)})"
    word = words[op]
    if op in ("not", "next", "prev"):
        return f"{word} ({write(operands[0])})"
    interval = ""
    if operands[0] is not None:
        low, high = operands[0]
        interval = brackets.format(low, "" if high == "inf" else high)
    if len(operands) == 2:
        return f"{word}{interval} ({write(operands[1])})"
    return f"({write(operands[1])}) {word}{interval} ({write(operands[2])})"


def nodes_of(formula):
    """Return the nodes of the formula and its root for `tests/oracle.py`, derived operators by definition."""
    builder = Builder()
    root = _node(builder, formula)
    nodes, order = reachable(builder.nodes, [root])
    return nodes, order[root]


def _node(builder, formula):
    op, operands = formula[0], formula[1:]
    if op == "pred":
        left, right = builder.add("signal", value=operands[0]), builder.add("const", value=float(operands[2]))
        return builder.add(_COMPARISONS[operands[1]], [left, right])
    if op == "bool":
        return builder.add("bool", value=operands[0])
    if op in _DERIVED:
        return _node(builder, _DERIVED[op](*operands))
    if op in ("not", "and", "or", "next", "prev"):
        return builder.add(op, [_node(builder, part) for part in operands])
    names = {"G": "always", "F": "eventually", "U": "until", "H": "historically", "O": "once", "S": "since"}
    low, high = operands[0] or (0, "inf")
    children = [_node(builder, part) for part in operands[1:]]
    return builder.add(names[op], children, interval=(low, None if high == "inf" else high))


_DERIVED = {
    "implies": lambda p, q: ["or", ["not", p], q],
    "iff": lambda p, q: ["and", ["implies", p, q], ["implies", q, p]],
    "xor": lambda p, q: ["not", ["iff", p, q]],
    "R": lambda i, p, q: ["not", ["U", i, ["not", p], ["not", q]]],
    "W": lambda i, p, q: ["or", ["U", i, p, q], ["G", None if i is None else [0, i[1]], p]],
}
