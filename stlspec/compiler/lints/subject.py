"""What every lint looks at: the text, its meaning, and what is known of the values of its formulas.

In: the syntax and the model of a spec without errors. Out: `Subject`, made once for all passes. `truths` encloses
the robustness of a formula at any sample of any trace within the declared ranges, ties as `ranges.TIE` says: so
above 0 is "always holds", and below 0 is "never holds".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from stlspec.compiler.ir import Node
from stlspec.compiler.lower import Sketch, sketch
from stlspec.compiler.model import Model
from stlspec.compiler.ranges import INF, WHOLE, Range, value_ranges
from stlspec.errors import Diagnostic, diagnostic
from stlspec.lang.nodes import Expression, LetStatement, RequirementStatement
from stlspec.lang.parse import Syntax
from stlspec.source import Span

_LONGEST_SHOWN = 60


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A spec under analysis.

    formulas: the bodies of its lets and requirements, templates left out. ranges: by real node, the values that it
    takes; truths: for each node, the robustness that it takes.
    """

    syntax: Syntax
    model: Model
    sketch: Sketch
    formulas: tuple[Expression, ...]
    ranges: Mapping[int, Range]
    truths: Sequence[Range]

    def truth(self, expression: Expression) -> Range:
        """Return the enclosure of the robustness of a formula."""
        return self.truths[self.sketch.made[id(expression)]]

    def text(self, span: Span) -> str:
        """Return a stretch of the text on one line, shortened."""
        line = " ".join(self.syntax.source.slice(span).split())
        return line if len(line) <= _LONGEST_SHOWN else f"{line[: _LONGEST_SHOWN - 3]}..."

    def warn(self, code: str, span: Span, **fields: Any) -> Diagnostic:
        """Make a warning at a place of the main file."""
        return diagnostic(code, source=self.syntax.source, span=span, **fields)


def make_subject(syntax: Syntax, model: Model) -> Subject:
    """Work out what all passes need."""
    drawn = sketch(model)
    ranges = value_ranges(drawn.nodes, tuple(model.signals.values()), model.declared.time)
    formulas = []
    for statement in syntax.statements:
        match statement:
            case LetStatement(arguments=(), body=body):
                formulas.append(body)
            case RequirementStatement(formula=formula):
                formulas.append(formula)
    known = tuple(formula for formula in formulas if id(formula) in drawn.made)
    return Subject(syntax, model, drawn, known, ranges, truths(drawn.nodes, ranges))


def truths(nodes: Sequence[Node], ranges: Mapping[int, Range]) -> list[Range]:
    """Enclose the robustness of every formula at any sample of any trace; real nodes have `WHOLE`.

    Not in the paper: it evaluates formulas on traces only.

    Args:    nodes: children first. ranges: of predicates and real nodes, as `value_ranges` gives them.
    Returns: (low, high) for each node.
    """
    found: list[Range] = []
    for index, node in enumerate(nodes):
        below = [found[child] for child in node.children]
        found.append(ranges.get(index, WHOLE) if index in ranges else _truth(node, below))
    return found


def _truth(node: Node, below: Sequence[Range]) -> Range:
    # A window that begins at 0 holds the sample at hand; any other may be empty, which is -inf or +inf.
    may_be_empty = node.interval is not None and node.interval[0] > 0
    match node.op:
        case "true":
            return INF, INF
        case "false":
            return -INF, -INF
        case "not":
            return -below[0][1], -below[0][0]
        case "and":
            return min(low for low, _ in below), min(high for _, high in below)
        case "or":
            return max(low for low, _ in below), max(high for _, high in below)
        case "always" | "historically":
            return below[0][0], INF if may_be_empty else below[0][1]
        case "eventually" | "once":
            return -INF if may_be_empty else below[0][0], below[0][1]
        case "next" | "prev":
            return -INF, below[0][1]
        case "until" | "since":
            # At the sample at hand the right side alone decides.
            return -INF if may_be_empty else below[1][0], below[1][1]
    return WHOLE
