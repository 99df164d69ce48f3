"""What is evaluated: formulas as nested lists, and data, the same for every contestant.

In: a folder. Out: jobs that name a file of data and carry the formula in the contestant's own notation.
"""

import numpy as np

from tests.peers.syntax import WRITERS

P, Q, R = ["pred", "x", ">=", -0.5], ["pred", "y", ">=", 0.5], ["pred", "x", "<=", 1.5]
ALWAYS_POSSIBLE = ["pred", "x", ">=", -9.0]
"""Never near its bound, so that an until over it stays open."""

_NEAR, _CALM = ["F", [0, 50], Q], ["G", [0, 100], P]
EIGHT = [
    ["G", [0, 500], P],
    ["F", [0, 500], Q],
    ["G", [0, 400], ["implies", P, _NEAR]],
    ["G", [0, 400], ["implies", R, _NEAR]],
    ["F", [0, 300], _CALM],
    ["G", [0, 300], ["or", _NEAR, _CALM]],
    ["U", [0, 200], P, Q],
    ["G", [0, 200], ["U", [0, 50], P, Q]],
]
"""Eight requirements that share sub-formulas; every window ends within 500 samples."""

SHAPES = ("random", "rising", "falling", "sawtooth")


def texts(tool, formulas):
    """Formulas as a tool reads them: mstlo's until holds its left operand at t' too, Reelay looks back."""
    if tool == "mstlo":
        formulas = [closed(formula) for formula in formulas]
    if tool == "reelay":
        formulas = [mirrored(formula) for formula in formulas]
    return [WRITERS[tool](formula) for formula in formulas]


def closed(formula):
    """Replace p until q by the nearest that mstlo can say, p until (p and q): the same work, another value."""
    parts = [closed(part) if _is_formula(part) else part for part in formula]
    return ["U", parts[1], parts[2], ["and", parts[2], parts[3]]] if parts[0] == "U" else parts


def mirrored(formula):
    """Replace future operators by past ones, for a trace that comes backwards."""
    past = {"G": "H", "F": "O", "U": "S"}
    return [
        mirrored(part) if _is_formula(part) else past.get(part, part) if index == 0 else part
        for index, part in enumerate(formula)
    ]


def _is_formula(part):
    return isinstance(part, list) and bool(part) and isinstance(part[0], str)


class Data:
    """Files of random numbers under a folder: a trace, a batch, streams of several shapes."""

    def __init__(self, folder, longest):
        folder.mkdir(parents=True, exist_ok=True)
        self.long = self._save(folder / "long.npz", 1, longest)
        self.short = self._save(folder / "short.npz", 2, 100_000)
        self.batch = self._save(folder / "batch.npz", 3, (1000, 1000))
        self.streams = {}
        for shape in SHAPES:
            self.streams[shape] = str(folder / f"{shape}.npz")
            x, y = (wave(shape, 20_000, np.random.default_rng(seed)) for seed in (4, 5))
            np.savez(self.streams[shape], x=x, y=y - 1)

    @staticmethod
    def _save(path, seed, shape):
        # A seed for each file: what is in it does not depend on the size of the others.
        rng = np.random.default_rng(seed)
        np.savez(path, x=rng.uniform(-1, 2, shape), y=rng.uniform(-2, 1, shape))
        return str(path)

    def job(self, tool, kind, formulas, data, n, **more):
        """Return a job for a contestant."""
        return tool, {"kind": kind, "texts": texts(tool, formulas), "data": data, "n": n, **more}


def wave(shape, n, rng):
    """Return n numbers from -1 to 2: the inputs that are best and worst for a sliding window."""
    if shape == "random":
        return rng.uniform(-1, 2, n)
    ramp = np.linspace(-1, 2, n)
    if shape == "sawtooth":
        return -1 + 3 * (np.arange(n) % 97) / 97
    return ramp if shape == "rising" else ramp[::-1]


def spec_of_30_lines():
    """Return a spec as a person would write it, 30 lines long."""
    head = ['spec benchmark "Thirty lines"', "time step", "", "param T = 200", ""]
    signals = [f'signal s{i} "signal number {i}"' for i in range(8)]
    lets = ["", "let near = s0 < 1", "let slow = abs(s2) <= 0.5", ""]
    hard = [f"hard safe{i}: always (s{i} >= 0 and s{i} <= 9)" for i in range(6)]
    soft = [
        "",
        "soft reach depends on safe0: eventually near",
        "soft fast depends on safe0, reach: eventually[0, T] near",
        "soft calm depends on safe1: always[0, 50] (near implies slow)",
        "soft answer depends on safe2: always (s3 > 1 implies eventually[0, 20] (s4 > 2))",
        "soft order depends on safe3: (s5 < 4) until[0, 100] (s6 > 3)",
        "soft past depends on safe4: always (s7 > 1 implies once[0, 5] near)",
        "",
    ]
    return "\n".join([*head, *signals, *lets, *hard, *soft])
