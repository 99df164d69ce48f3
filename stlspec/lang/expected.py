"""What would fit, in the words of the language.

In: terminals of the grammar, or a piece of the text. Out: words for a message.
"""

_SHOWN = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted text",
    "UNIT": "a unit",
    "$END": "the end of the statement",
}
_WORDS = "depends on,on,scale,bound,unit,in,from,holds,fails,episode,at,margin,is,outranks".split(",")
"""Words of clauses, as they are named where they fit."""


def quoted(text: str) -> str:
    """Return a piece of the text in backticks, short and printable.

    Not in the paper: it serves the messages.
    """
    shown = "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)
    return f"`{shown if len(shown) <= 30 else shown[:29] + '…'}`"


def expected(terminals: frozenset[str]) -> str:
    """Name at most five things that fit, in the words of the language.

    Not in the paper: it serves the messages.

    Args:    terminals: what the automaton would take.
    Returns: such as "`)`, an operator or `scale`".
    """
    named: list[str] = []
    if {"NAME", "NUMBER", "LPAR"} <= terminals:
        named.append("a formula" if "NOT" in terminals else "a number or a signal")
    else:
        if {"AND", "OR"} <= terminals:
            named.append("an operator")
        elif "PLUS" in terminals:
            named.append("an arithmetic operator")
        named += [text for terminal, text in _SHOWN.items() if terminal in terminals]
    signs = {"COMMA": ",", "COLON": ":", "RPAR": ")", "RSQB": "]", "RBRACE": "}", "ASSIGN": "=", "LSQB": "["}
    if "AND" not in terminals and "NOT" not in terminals:
        signs_shown = [f"`{sign}`" for terminal, sign in signs.items() if terminal in terminals]
    else:
        signs_shown = [f"`{s}`" for t, s in signs.items() if t in terminals and t in ("RPAR", "RSQB", "COMMA")]
    named = signs_shown + named
    named += ["data in braces"] if "LBRACE" in terminals else []
    named += ["`>=`"] if "GE" in terminals and "LT" not in terminals else []
    named += [f"`{w}`" for w in _WORDS if w.split()[0].upper().replace("UNIT", "UNIT_WORD") in terminals]
    shown = named[:5]
    if len(shown) < 2:
        return shown[0] if shown else "nothing more"
    return f"{', '.join(shown[:-1])} or {shown[-1]}"
