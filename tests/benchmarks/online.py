"""Streams: microseconds for a whole `monitor.update`, for each reading, beside the tools that have one.

Windows are full before anything is timed. Peers take prepared samples too. What the loop costs without a
monitor is measured and shown, not taken off.
"""

from tests.benchmarks.offline import faster, ratio
from tests.benchmarks.table import Goal, Section
from tests.benchmarks.workloads import ALWAYS_POSSIBLE, SHAPES, P, Q

N = 20_000


def every(arena, data):
    """The exact value at each sample, late by the horizon, and how it grows with w."""
    sections = []
    widths = (10, 1000) if arena.quick else (10, 100, 1000, 4000)
    formulas = {
        "always[0, w]": lambda w: ["G", [0, w], P],
        "eventually[0, w]": lambda w: ["F", [0, w], Q],
        "until[0, w]": lambda w: ["U", [0, w], ALWAYS_POSSIBLE, Q],
        "always[0, w] (p implies eventually[0, w] q)": lambda w: ["G", [0, w], ["implies", P, ["F", [0, w], Q]]],
    }
    for name, formula in formulas.items():
        own = {}
        for w in widths:
            figures = arena.contest(_stream_jobs(data, formula(w), w, name))
            section = Section(f"online, every, {name}, w = {w}")
            section.contest(figures, "us")
            if name in ("always[0, w]", "eventually[0, w]", "until[0, w]"):
                section.goals = [faster("times faster than mstlo, value taken out", figures, "mstlo", 1)]
            own[w] = figures["stlspec"].median
            sections.append(section)
        sections[-1].notes.append(f"w = {widths[-1]} over w = 10: {own[widths[-1]] / own[10]:.2f}")
    return sections


def _stream_jobs(data, formula, w, name):
    warm = 3 * w + 10

    def job(tool, kind="every", **more):
        return data.job(tool, kind, [formula], data.streams["random"], N, warm=warm, **more)

    jobs = {
        "stlspec": job("stlspec"),
        "(the loop alone)": job("stlspec", "nothing"),
        "mstlo": job("mstlo"),
        "mstlo, nothing taken out": job("mstlo", ready=True),
    }
    if name in ("always[0, w]", "eventually[0, w]"):
        jobs["reelay (past)"] = job("reelay")
    if w <= 100 or (name in ("always[0, w]", "eventually[0, w]") and w <= 1000):
        jobs["rtamt"] = job("rtamt")
    return jobs


def start(arena, data):
    """The enclosure at sample 0: one level and two, short and wide windows, four shapes of input."""
    section = Section("online, start: enclosure at sample 0, one requirement, whole call, random input")
    one = {
        "always p": (["G", None, P], 2),
        "eventually q": (["F", None, Q], 2),
        "p until q": (["U", None, ALWAYS_POSSIBLE, Q], 2),
    }
    two = {
        "always (p implies eventually[0, w] q)": lambda w: ["G", None, ["implies", P, ["F", [0, w], Q]]],
        "eventually always[0, w] p": lambda w: ["F", None, ["G", [0, w], P]],
        "always (p until[0, w] q)": lambda w: ["G", None, ["U", [0, w], ALWAYS_POSSIBLE, Q]],
    }

    def job(formula, shape="random", w=0):
        return data.job("stlspec", "start", [formula], data.streams[shape], N, warm=3 * w + 10)

    jobs = {name: job(formula) for name, (formula, _) in one.items()}
    jobs |= {f"{name}, w = {w}": job(make(w), "random", w) for name, make in two.items() for w in (10, 4000)}
    figures = arena.contest(jobs | {"(the loop alone)": data.job("stlspec", "nothing", [P], data.short, N)})
    section.contest(figures, "us")
    for name, (_, bound) in one.items():
        section.goals.append(_microseconds(f"us, {name}", figures[name], bound))
    for name in two:
        section.goals.append(_microseconds(f"us, {name}, w = 4000", figures[f"{name}, w = 4000"], 4))
    for name, make in two.items():
        tail = arena.quantiles(*job(make(4000), "random", 4000), N, [0.99])[0]
        section.goals.append(Goal(f"p99 in us (wall clock), {name}, w = 4000", tail * 1e6, 10, at_least=False))
    return [section, _shapes(arena, job, two)]


def _shapes(arena, job, two):
    """How the mean grows from w = 10 to w = 4000 on inputs that are best and worst for a window."""
    section = Section("online, start: w = 4000 over w = 10, by the shape of the input")
    shapes = ("random", "rising") if arena.quick else SHAPES
    for name, make in two.items():
        jobs = {f"{shape}, w = {w}": job(make(w), shape, w) for shape in shapes for w in (10, 4000)}
        figures = arena.contest(jobs)
        for shape in shapes:
            grown = ratio(figures, f"{shape}, w = 4000", f"{shape}, w = 10")
            section.goals.append(Goal(f"{name}, {shape}", grown, 1.3, at_least=False))
    return section


def _microseconds(text, figure, bound):
    return Goal(text, None if figure.median is None else figure.median * 1e6, bound, at_least=False)


def pending(arena, data):
    """Enclosures at all open samples after each update, beside mstlo's interval verdicts."""
    formulas = {
        "always[0, w]": (lambda w: ["G", [0, w], P], 10),
        "until[0, w]": (lambda w: ["U", [0, w], ALWAYS_POSSIBLE, Q], 50),
        "always[0, w] (p implies eventually[0, w] q)": (
            lambda w: ["G", [0, w], ["implies", P, ["F", [0, w], Q]]],
            500,
        ),
    }
    sections = []
    for name, (make, bound) in formulas.items():
        section = Section(f"online, all pending enclosures after each update, {name}")
        for w in (1000,) if arena.quick else (1000, 4000):
            jobs = {f"stlspec, w = {w}": _pending_job(data, "stlspec", make(w), w)}
            if w == 1000 or name == "always[0, w]":
                jobs[f"mstlo, w = {w}"] = _pending_job(data, "mstlo", make(w), w)
                jobs[f"mstlo, nothing taken out, w = {w}"] = _pending_job(data, "mstlo", make(w), w, ready=True)
            figures = arena.contest(jobs)
            section.contest(figures, "us")
            own = figures[f"stlspec, w = {w}"]
            if w == 4000:
                section.goals.append(_microseconds("us, update and pending, w = 4000", own, bound))
            if f"mstlo, w = {w}" in figures:
                text = f"times faster than mstlo, values taken out, w = {w}"
                section.goals.append(faster(text, figures, f"mstlo, w = {w}", 30, f"stlspec, w = {w}"))
        sections.append(section)
    return sections


def _pending_job(data, tool, formula, w, **more):
    return data.job(tool, "pending", [formula], data.streams["random"], N, warm=2 * w + 10, **more)
