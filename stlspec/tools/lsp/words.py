"""What each word of the language means, for hover and completion.

In: a word, or the name of an operator. Out: its form and one or two sentences. Words of clauses mean something only
where the grammar takes them as words, so they are looked up by terminal.
"""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Word:
    """How something is written, and what it means."""

    form: str
    meaning: str


STATEMENTS: Mapping[str, Word] = {
    "spec": Word('spec NAME ["title"]', "The name of the spec; at most one, before all other statements."),
    "use": Word('use "file.stl"', "Brings in the signals, params and lets of another file, found from this one."),
    "time": Word(
        "time step | time 100 ms | time s",
        "How time is measured: bounds count samples; or samples come in a period; or time stamps come with the data.",
    ),
    "signal": Word(
        'signal NAME [: real | bool] [unit "m/s"] [in [lo, hi]] [from "column or path"] ["doc"]',
        "A quantity over time that the data, or an environment, offers.",
    ),
    "param": Word(
        'param NAME [= NUMBER [UNIT]] ["doc"]',
        "A constant; without a value it is bound from outside, with `-p NAME=VALUE`.",
    ),
    "let": Word(
        "let NAME [(ARG, ...)] = EXPRESSION or FORMULA",
        "A name for a part of formulas; with arguments a template. Naming a part never changes a value.",
    ),
    "hard": Word(
        'hard NAME ["doc"] [depends on A, B] [scale NUMBER] [bound tanh|linear|none]: FORMULA',
        "A requirement that must hold: a demonstration that breaks it is `bad`.",
    ),
    "soft": Word(
        'soft NAME ["doc"] [depends on A, B] [scale NUMBER] [bound tanh|linear|none]: FORMULA',
        "A requirement that is wanted: a demonstration that misses it is `incomplete`.",
    ),
    "expect": Word(
        'expect NAME holds|fails on DATA | expect "file" is good|incomplete|bad | expect "a" outranks "b"',
        "A test of the spec itself; `stlspec test` runs it.",
    ),
}

OPERATORS: Mapping[str, Word] = {
    "always": Word(
        "always[a, b] p", "p holds at every sample of the window; true if it is empty. Robustness: the minimum."
    ),
    "eventually": Word(
        "eventually[a, b] p", "p holds at some sample of the window; false if it is empty. Robustness: the maximum."
    ),
    "historically": Word("historically[a, b] p", "p held at every sample from b to a before now."),
    "once": Word("once[a, b] p", "p held at some sample from b to a before now."),
    "next": Word("next p", "p holds at the next sample; false at the last one."),
    "prev": Word("prev p", "p held at the previous sample; false at the first one."),
    "wnext": Word("wnext p", "p holds at the next sample, if there is one."),
    "wprev": Word("wprev p", "p held at the previous sample, if there is one."),
    "until": Word(
        "p until[a, b] q", "q holds at some sample of the window, and p at all samples from now to before it."
    ),
    "since": Word("p since[a, b] q", "q held at some sample of the window before now, and p at all samples after it."),
    "unless": Word("p unless[a, b] q", "p until q, or p all the way to b: q need not come."),
    "release": Word(
        "p release[a, b] q", "q holds in the window up to and with the sample where p does; p need not come."
    ),
    "not": Word("not p", "p does not hold. Robustness: minus that of p."),
    "and": Word("p and q", "Both hold. Robustness: the minimum."),
    "or": Word("p or q", "At least one holds. Robustness: the maximum."),
    "xor": Word("p xor q", "Exactly one holds."),
    "implies": Word("p implies q", "q holds wherever p does: `not p or q`."),
    "iff": Word("p iff q", "Both hold or neither does."),
    "lt": Word("f < g", "f is less than g. Robustness: g - f."),
    "le": Word("f <= g", "f is at most g. Robustness: g - f; where it is 0, this holds."),
    "gt": Word("f > g", "f is greater than g. Robustness: f - g."),
    "ge": Word("f >= g", "f is at least g. Robustness: f - g; where it is 0, this holds."),
    "eq": Word("f == g", "f equals g. Robustness: minus the distance, so never above 0."),
    "ne": Word("f != g", "f differs from g. Robustness: the distance."),
    "assign": Word("f = g", "Write `==` to compare."),
    "add": Word("f + g", "The sum."),
    "sub": Word("f - g", "The difference."),
    "mul": Word("f * g", "The product."),
    "div": Word("f / g", "The quotient."),
    "pow": Word("f ** g", "f to the power of g; groups to the right."),
    "neg": Word("-f", "The negative; it binds looser than `**`."),
}
"""By the name of the operator's rule in the grammar."""

FUNCTIONS: Mapping[str, Word] = {
    "abs": Word("abs(x)", "The absolute value."),
    "min": Word("min(x, y, ...)", "The smallest of two or more numbers at the same sample."),
    "max": Word("max(x, y, ...)", "The largest of two or more numbers at the same sample."),
    "sqrt": Word("sqrt(x)", "The square root."),
    "exp": Word("exp(x)", "e to the power of x."),
    "log": Word("log(x)", "The natural logarithm."),
    "sin": Word("sin(x)", "The sine of an angle in radians."),
    "cos": Word("cos(x)", "The cosine of an angle in radians."),
    "hypot": Word("hypot(x, y)", "The length of the vector (x, y)."),
    "delta": Word("delta(x)", "The change since the previous sample; 0 at the first."),
    "rate": Word("rate(x)", "The change since the previous sample per unit of time; 0 at the first."),
}

CONSTANTS: Mapping[str, Word] = {
    "true": Word("true", "Holds at every sample."),
    "false": Word("false", "Holds at no sample."),
    "inf": Word("inf", "No end: `eventually[2, inf] p`; or an infinite number."),
    "now": Word("now", "The time since the first sample, in the unit of the `time` statement."),
}

CLAUSES: Mapping[str, Word] = {
    "DEPENDS": Word("depends on A, B", "A and B come first: what others depend on weighs more."),
    "ON": Word("on", "Names the requirements that come first, or the data of an expectation."),
    "SCALE": Word("scale NUMBER", "The robustness that counts as 1 before it is bounded."),
    "BOUND": Word(
        "bound tanh|linear|none", "How robustness is bounded before it is weighed; `tanh` if nothing is said."
    ),
    "UNIT_WORD": Word('unit "m/s"', "The unit of the signal; without it the signal is a plain number."),
    "IN": Word("in [lo, hi]", "A promise, in the signal's unit: a sample outside it is refused."),
    "FROM": Word(
        'from "column or path"', 'Where the signal is read from: another column, or `"obs[0]"`, `"info.speed"`.'
    ),
    "HOLDS": Word("holds on DATA", "The requirement is expected to hold on the data."),
    "FAILS": Word("fails on DATA", "The requirement is expected to be violated on the data."),
    "EPISODE": Word('"file" episode 3', "One demonstration of a file that holds several, by number or by name."),
    "AT": Word("at K", "The sample at which the verdict is taken; a negative number counts from the end."),
    "MARGIN": Word("margin >= M", "The absolute value of the robustness is at least M."),
    "IS": Word('"file" is good|incomplete|bad', "The label that the demonstration is expected to get."),
    "OUTRANKS": Word('"a.csv" outranks "b.csv"', "a has the better label, or the same and a greater reward."),
}
"""By terminal."""

VALUES: Mapping[str, Word] = {
    "real": Word(": real", "The signal is a number; so it is if nothing is said."),
    "bool": Word(": bool", "The signal is true or false, and is a formula by itself."),
    "tanh": Word("bound tanh", "Robustness over scale, through tanh: between -1 and 1, smooth."),
    "linear": Word("bound linear", "Robustness over scale, clipped to [-1, 1]."),
    "none": Word("bound none", "Robustness over scale as it is."),
    "good": Word("is good", "All requirements hold."),
    "incomplete": Word("is incomplete", "The hard requirements hold, and a soft one fails."),
    "bad": Word("is bad", "A hard requirement fails."),
}
