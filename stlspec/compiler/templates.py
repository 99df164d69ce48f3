"""Templates: lets with arguments, typed for each use.

In: calls such as `near(d_goal, 1)`. Out: an `Instance` for every distinct list of arguments: the typings of the
template's body with these arguments for its names. Nothing is substituted in text, and no tree is copied: an
argument's name stands for the typing of what was given, which was worked out where the call stands, so no name in
it can be caught by the template. Two calls with the same arguments share an instance, so that templates which use
one another twice cost no more than once; distinct ones are counted, and refused beyond a limit.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from stlspec.compiler.advice import short
from stlspec.compiler.inference import Inference
from stlspec.compiler.model import BROKEN, FORMULA, Declared, Instance, Typing
from stlspec.errors import Diagnostic, Label
from stlspec.lang.nodes import (
    Call,
    Expression,
    Group,
    Index,
    Infinity,
    Infix,
    LetStatement,
    Name,
    Number,
    Truth,
    children,
    operators,
    post_order,
)
from stlspec.lang.parse import Syntax
from stlspec.source import SourceText

DEEPEST = 50
"""How many templates may stand on one another."""
MOST_NODES = 100_000
"""How many operators and operands all distinct uses of templates may come to."""
_MOST_SAID = 3
_QUOTED_NAME = re.compile(r"`([A-Za-z_][A-Za-z_0-9]*)")
_CONTEXT = (
    "source",
    "nameless",
    "_names_seen",
    "arguments",
    "keys",
    "typings",
    "intervals",
    "calls",
    "problems",
    "_said",
)


class TemplateInference(Inference):
    """The typing of expressions in which templates are called."""

    def __init__(self, syntax: Syntax, declared: Declared, silent: frozenset[str], problems: list[Diagnostic]) -> None:
        super().__init__(syntax, declared, silent, problems)
        self.calls: dict[int, Instance] = {}
        self.arguments: Mapping[str, Typing] = {}
        self.keys: Mapping[str, int] = {}
        self._instances: dict[tuple[str, tuple[int, ...]], Instance] = {}
        self._interned: dict[tuple[object, ...], int] = {}
        self._depths: dict[str, int] = {}
        self._n_nodes = 0
        self._n_nodes_said = False
        self._templates = frozenset(name for name, let in declared.lets.items() if let.arguments)
        self._named: set[int] = set()

    def template(self, let: LetStatement) -> Typing:
        """Type the body of a template for arguments of any kind, and report what is wrong whatever they are.

        Returns: BROKEN if something was reported.
        """
        name = let.name.text
        self._said.clear()
        again = _repeated(let.arguments)
        if again is not None:
            return self._report("N114", again.span, name=again.text)
        called = [n.function.text for n in _all_nodes(let.body) if isinstance(n, Call)]
        self._depths[name] = 1 + max((self._depths.get(other, 0) for other in called), default=0)
        broken = any(self.scope.get(other) == BROKEN for other in called)
        if not broken and self._depths[name] > DEEPEST:
            return self._report("N115", let.name.span, name=name, what=f"more than {DEEPEST} templates deep")
        before = len(self.problems)
        self.arguments = dict.fromkeys((argument.text for argument in let.arguments), BROKEN)
        self._walk(let.body)
        self.arguments = {}
        return BROKEN if broken or any(p.severity == "error" for p in self.problems[before:]) else FORMULA

    def sees(self, name: str) -> bool:
        """Tell whether a name is an argument, or in scope and declared where this file sees it."""
        return name in self.arguments or super().sees(name)

    def known(self) -> Iterable[str]:
        """Return the names that may have been meant by one that is not known."""
        return (*self.arguments, *self.scope)

    def _walk(self, root: Expression) -> Typing:
        if self._templates:
            calls = [n for n in post_order(root) if isinstance(n, Call) and n.function.text in self._templates]
            named = [a for call in calls for a in call.arguments if _is_named(a)]
            self._named.update(id(node) for argument in named for node in post_order(argument))
        return super()._walk(root)

    def _node(self, node: Expression) -> Typing:
        return BROKEN if id(node) in self._named else super()._node(node)

    def _name(self, node: Name) -> Typing:
        name = node.text
        if name in self.arguments:
            return self.arguments[name]
        let = self._template_of(name)
        if let is None:
            return super()._name(node)
        if self.scope.get(name, BROKEN) == BROKEN:
            return BROKEN
        return self._report("N113", node.span, (self.declared.place(name),), **_usage(let, "no arguments"))

    def _template_of(self, name: str) -> LetStatement | None:
        """Return the template that a name stands for here."""
        let = self.declared.lets.get(name)
        return let if let is not None and let.arguments and name not in self.arguments and self.sees(name) else None

    def _call(self, node: Call, below: list[Typing]) -> Typing:
        let = self._template_of(node.function.text)
        if let is None:
            return super()._call(node, below)
        name = let.name.text
        if any(_is_named(argument) for argument in node.arguments):
            return self._report("N113", node.span, (self.declared.place(name),), **_usage(let, "arguments by name"))
        if len(below) != len(let.arguments):
            given = f"{len(below)} argument" + ("s" if len(below) != 1 else "")
            return self._report("N113", node.span, (self.declared.place(name),), **_usage(let, given))
        if BROKEN in (self.scope[name], *below):
            return BROKEN
        key = (name, tuple(self._key(argument) for argument in node.arguments))
        instance = self._instances.get(key)
        if instance is None:
            if self._n_nodes > MOST_NODES:
                said, self._n_nodes_said = self._n_nodes_said, True
                what = f"more than {MOST_NODES} operators and operands"
                return BROKEN if said else self._report("N115", node.span, name=name, what=what)
            instance = self._instances[key] = self._instance(let, below, key[1])
        self.calls[id(node)] = instance
        self.problems += [_at_call(problem, node, self.source, let) for problem in instance.problems]
        return instance.result

    def _instance(self, let: LetStatement, below: list[Typing], keys: Sequence[int]) -> Instance:
        """Type the body of a template for some arguments."""
        outer = {name: getattr(self, name) for name in _CONTEXT}
        names = [argument.text for argument in let.arguments]
        self.enter(self.declared.files[let.name.text])
        self.arguments, self.keys = dict(zip(names, below, strict=True)), dict(zip(names, keys, strict=True))
        self.typings, self.intervals, self.calls = {}, {}, {}
        self.problems, self._said = [], {}
        self._n_nodes += sum(1 for _ in _all_nodes(let.body))
        result = self._walk(let.body)
        errors = [problem for problem in self.problems if problem.severity == "error"]
        said = errors[:1] or self.problems[:_MOST_SAID]
        made = Instance(let, self.typings, self.intervals, self.calls, result, tuple(said))
        for name, value in outer.items():
            setattr(self, name, value)
        return made

    def _key(self, root: Expression) -> int:
        """Return a number that two arguments share if they are the same expression of the same things."""
        found: dict[int, int] = {}
        for node in post_order(root):
            below = [found[id(child)] for child in children(node)]
            if isinstance(node, Group):
                found[id(node)] = below[0]
                continue
            found[id(node)] = self._number_of((*self._parts(node), *below))
        return found[id(root)]

    def _parts(self, node: Expression) -> tuple[object, ...]:
        """Return what tells a node apart from others with the same operands."""
        match node:
            case Number():
                return ("number", repr(node.value), node.unit.text if node.unit else "")
            case Truth():
                return ("truth", node.value)
            case Infinity():
                return ("infinity",)
            case Name() | Index():
                name = node.text if isinstance(node, Name) else node.name.text
                return ("argument", self.keys[name]) if name in self.keys else ("name", name)
            case Call():
                instance = self.calls.get(id(node))
                return ("function", node.function.text, id(instance) if instance else 0)
        found: list[object] = []
        for operator in operators(node):
            found.append(operator.word)
            if operator.interval is not None:
                found += [self._key(operator.interval.low), self._key(operator.interval.high)]
        return tuple(found)

    def _number_of(self, parts: tuple[object, ...]) -> int:
        return self._interned.setdefault(parts, len(self._interned))


def _all_nodes(root: Expression) -> list[Expression]:
    """Return all nodes under `root`, those of bounds included."""
    found, pending = [], [root]
    while pending:
        for node in post_order(pending.pop()):
            found.append(node)
            pending += [b for o in operators(node) if o.interval for b in (o.interval.low, o.interval.high)]
    return found


def _repeated(arguments: Sequence[Name]) -> Name | None:
    seen: set[str] = set()
    for argument in arguments:
        if argument.text in seen:
            return argument
        seen.add(argument.text)
    return None


def _is_named(argument: Expression) -> bool:
    """Tell whether an argument is given by its name, as in other languages: `near(r = 2)`."""
    return isinstance(argument, Infix) and argument.operators[0].word == "assign"


def _usage(let: LetStatement, given: str) -> dict[str, str]:
    names = ", ".join(argument.text for argument in let.arguments)
    return {"name": let.name.text, "usage": f"{let.name.text}({names})", "given": given}


def _at_call(problem: Diagnostic, node: Call, source: SourceText, let: LetStatement) -> Diagnostic:
    """Move what does not fit in the body of a template to the call; the place in the body comes second.

    Where an argument's name does not fit, it is the argument that is shown and named.
    """
    assert problem.source is not None and problem.span is not None
    given = {a.text: g for a, g in zip(let.arguments, node.arguments, strict=True)}
    texts = {argument: short(source.slice(expression.span)) for argument, expression in given.items()}

    def named(text: str) -> str:
        return _QUOTED_NAME.sub(lambda match: "`" + texts.get(match[1], match[1]), text)

    word = problem.source.slice(problem.span)
    span = given[word].span if word in given else node.span
    name = let.name.text
    inside = Label(problem.span, f"in `{name}`" + (f": {problem.label}" if problem.label else ""), problem.source)
    deeper = problem.labels if len(problem.labels) < _MOST_SAID else problem.labels[1 - _MOST_SAID :]
    labels = (inside, *deeper)
    return replace(
        problem,
        message=named(problem.message),
        help=named(problem.help),
        source=source,
        file=source.name,
        span=span,
        label="",
        labels=labels,
        fixes=(),  # their edits are places in the body, not here
    )
