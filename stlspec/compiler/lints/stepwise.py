"""Hard requirements that `learn` cannot watch step by step.

In: a `Subject`. Out: L608, one for all of them. A requirement is watched if whatever violates it shows at some step,
however the run goes on: a safety property. It is lost at the end alone where it waits without a bound; and the
learner refuses a past over a future, and rates of rates (D868), since no finite memory tells their values in time.
"""

from collections.abc import Sequence

from stlspec.compiler.ir import COMPARISONS, FUTURE, PAST, TEMPORAL, Node
from stlspec.compiler.lints.subject import Subject
from stlspec.errors import Diagnostic, Label, diagnostic

_MANY_NAMES = 5


def check_stepwise(subject: Subject) -> list[Diagnostic]:
    """Report the hard requirements that no single step can be seen to violate, all in one."""
    requirements = subject.model.declared.requirements
    watch = _Watch(subject)
    names = [
        name
        for name, root in subject.sketch.roots.items()
        if requirements[name].strength == "hard" and not watch.shows(root)
    ]
    if not names:
        return []
    shown = ", ".join(f"`{n}`" for n in names[:_MANY_NAMES])
    if names[_MANY_NAMES:]:
        shown += f" and {len(names) - _MANY_NAMES} more"
    source = subject.syntax.source
    labels = tuple(Label(requirements[n].name.span, "nor can this", source) for n in names[1:_MANY_NAMES])
    span = requirements[names[0]].name.span
    return [diagnostic("L608", source=source, span=span, labels=labels, names=shown)]


class _Watch:
    """The rule over one DAG."""

    def __init__(self, subject: Subject) -> None:
        self._nodes = subject.sketch.nodes
        # A bound that has no value yet is a bound.
        self._undecided = subject.sketch.undecided
        self._ahead = _below(self._nodes, FUTURE)
        self._refused = _refused(self._nodes, self._ahead)

    def shows(self, root: int) -> bool:
        """Tell whether a step can be seen to violate a formula whenever it is violated."""
        pending, seen = [(root, False)], set[tuple[int, bool]]()
        while pending:
            index, negated = pending.pop()
            if (index, negated) in seen:
                continue
            seen.add((index, negated))
            node = self._nodes[index]
            if self._refused[index]:
                return False
            if not self._ahead[index]:
                continue
            if self._is_unless(node) and not negated:
                until = next(c for c in node.children if self._nodes[c].op == "until")
                pending += [(child, False) for child in self._nodes[until].children]
                continue
            if self._waits(index, node, negated):
                return False
            pending += [(child, negated != (node.op == "not")) for child in node.children]
        return True

    def _waits(self, index: int, node: Node, negated: bool) -> bool:
        """Tell whether an operator may hold, or be violated, by nothing but going on for ever."""
        if node.op not in ("always", "eventually", "until") or (node.op == "always") != negated:
            return False
        return index not in self._undecided and node.interval is not None and node.interval[1] is None

    def _is_unless(self, node: Node) -> bool:
        """Tell whether this is `p unless q`, whose parts `p until q` and `always p` make up for each other."""
        if node.op != "or" or len(node.children) != 2:
            return False
        parts = {self._nodes[c].op: self._nodes[c] for c in node.children}
        return parts.keys() == {"until", "always"} and parts["always"].children[0] == parts["until"].children[0]


def _below(nodes: Sequence[Node], ops: frozenset[str]) -> list[bool]:
    """Tell of each node whether one of some operators is in it."""
    found: list[bool] = []
    for node in nodes:
        found.append(node.op in ops or any(found[child] for child in node.children))
    return found


def _refused(nodes: Sequence[Node], ahead: Sequence[bool]) -> list[bool]:
    """Tell of each node whether `learn` refuses it: the past of a future, a rate of a rate, a rate beside `now`."""
    found: list[bool] = []
    timed = _below(nodes, frozenset({"now"}))
    depths: list[int] = []
    for index, node in enumerate(nodes):
        below = max((depths[c] for c in node.children), default=0)
        depths.append(0 if node.op in COMPARISONS or node.op in TEMPORAL else below + (node.op in ("delta", "rate")))
        late = node.op in PAST and any(ahead[c] for c in node.children)
        steep = node.op in COMPARISONS and (below > 1 or (below > 0 and timed[index]))
        found.append(late or steep or any(found[c] for c in node.children))
    return found
