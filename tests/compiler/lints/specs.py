"""Random specs with declared ranges, and traces that stay in them."""

from tests.oracle import Oracle

RANGES = {"x": (0, 3), "y": (-1, 2), "z": (0, 6)}
"""Small whole numbers, so that bounds are met and contradictions are frequent."""
HEAD = "".join(f"signal {name} in [{low}, {high}]\n" for name, (low, high) in RANGES.items()) + "signal p: bool\n"
_WINDOWS = ("", "[0, 2]", "[0, 1]", "[1, 3]", "[2, 2]")


def random_formula(rng, depth=3):
    """Return the text of a formula, in brackets."""
    if depth == 0 or rng.random() < 0.25:
        if rng.random() < 0.1:
            return "p"
        term = rng.choice([*RANGES, "x + y", "x - y", "2 * x", "abs(y)", "min(x, z)"])
        return f"({term} {rng.choice(['<', '<=', '>', '>=', '=='])} {rng.randint(-2, 7)})"
    inner = random_formula(rng, depth - 1)
    shape = rng.random()
    if shape < 0.45:
        return f"({rng.choice(['always', 'eventually', 'once', 'historically'])}{rng.choice(_WINDOWS)} {inner})"
    if shape < 0.55:
        return f"({rng.choice(['not', 'next', 'wnext', 'prev'])} {inner})"
    word = rng.choice(["and", "or", "implies", "and", "until[0, 2]", "since", "release", "iff"])
    return f"({inner} {word} {random_formula(rng, depth - 1)})"


def random_spec(rng, count=3):
    """Return a spec of hard requirements, often about the same conditions."""
    bodies = [random_formula(rng, rng.randint(0, 3)) for _ in range(count)]
    for i in range(1, count):
        if rng.random() < 0.4:
            bodies[i] = f"({rng.choice(['always', 'eventually'])}{rng.choice(_WINDOWS)} {bodies[0]})"
    return HEAD + "".join(f"hard r{i}: {body}\n" for i, body in enumerate(bodies))


def random_trace(rng):
    """Return signals within their ranges; half of the values lie on the ends of these."""
    n = rng.randint(1, 6)
    signals = {}
    for name, (low, high) in RANGES.items():
        signals[name] = [rng.choice([low, high, rng.randint(low, high), rng.uniform(low, high)]) for _ in range(n)]
    signals["p"] = [rng.random() < 0.5 for _ in range(n)]
    return signals


def oracle_of(bundle, signals):
    """Return the definition, for a trace that counts samples."""
    return Oracle(bundle.nodes, signals, list(range(len(signals["p"]))), 1)
