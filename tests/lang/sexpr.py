"""Syntax trees as S-expressions, so that tests show how a text was read in one line."""

from stlspec.lang.nodes import Call, Group, Index, Infinity, Infix, Name, Number, Prefix, Truth

SIGNS = {
    "lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!=", "assign": "=",
    "add": "+", "sub": "-", "mul": "*", "div": "/", "pow": "**", "neg": "neg",
}  # fmt: skip
FOLDED = {"add", "sub", "mul", "div"}


def sexpr(node):
    """Write a tree with every pair of brackets that the precedence implies, and no other."""
    match node:
        case Name(_, text):
            return text
        case Number(_, value, unit):
            return f"{value:g}" + (f"_{unit.text}" if unit else "")
        case Truth(_, value):
            return "true" if value else "false"
        case Infinity():
            return "inf"
        case Group(_, inner):
            return sexpr(inner)
        case Index(_, name, index):
            return f"(index {name.text} {sexpr(index)})"
        case Call(_, function, arguments):
            return f"(call {function.text} {' '.join(map(sexpr, arguments))})"
        case Prefix(_, operator, operand):
            return f"({_operator(operator)} {sexpr(operand)})"
        case Infix():
            return _infix(node)


def _operator(operator):
    word = SIGNS.get(operator.word, operator.word)
    if operator.interval is None:
        return word
    return f"{word}[{sexpr(operator.interval.low)} {sexpr(operator.interval.high)}]"


def _infix(node):
    words = [_operator(operator) for operator in node.operators]
    operands = [sexpr(operand) for operand in node.operands]
    if node.operators[0].word in FOLDED:
        text = operands[0]
        for word, operand in zip(words, operands[1:], strict=True):
            text = f"({word} {text} {operand})"
        return text
    if len(set(words)) == 1:
        return f"({words[0]} {' '.join(operands)})"
    mixed = [x for pair in zip(words, operands[1:], strict=True) for x in pair]
    return f"(chain {operands[0]} {' '.join(mixed)})"
