"""Complete traces: one, many, long; windows short and wide; time beside other tools, and in passes over memory.

A pass is one `np.minimum(a, b, out=c)` over the same samples, the yardstick of what memory allows. Peers get
their data in their own form, ready; stlspec gets arrays (or lists) and is timed by whole calls of
`bundle.evaluate`, validation and packaging included.
"""

import numpy as np

from tests.benchmarks.table import Goal, Row, Section
from tests.benchmarks.workloads import EIGHT, P, Q


def ratio(figures, other, own="stlspec"):
    """How many times faster the own figure is than another; None if one is missing."""
    a, b = figures[other].median, figures[own].median
    return a / b if a and b else None


def faster(text, figures, other, bound, own="stlspec"):
    """Return the goal that the own figure is `bound` times faster than another."""
    a, b = figures[other], figures[own]
    if not a.median or not b.median:
        return Goal(text, None, bound)
    return Goal(text, a.median / b.median, bound, least=a.least / b.most, most=a.most / b.least)


def agreement(figures):
    """Note for each contestant whether its value at sample 0 is the one of stlspec."""
    own = figures["stlspec"].values
    return {
        label: "" if not figure.values or figure.values == own else "other values: see README"
        for label, figure in figures.items()
    }


def windows(arena, data):
    """One trace, always over 1001 samples, from arrays and from lists."""
    n, formula = 100_000, [["G", [0, 1000], P]]

    def job(tool, size=n, **more):
        return data.job(tool, "trace", formula, data.short, size, **more)

    figures = arena.contest(
        {
            "stlspec": job("stlspec"),
            "stlspec, and .signal of it": job("stlspec", signal=True),
            "stlspec, from lists": job("stlspec", lists=True, signal=True),
            "mstlo": job("mstlo"),
            "mstlo, pairs ready, nothing taken out": job("mstlo", ready=True),
            "stlrom, all samples, loaded": _whole(data, "stlrom", formula[0], n),
            "reelay (past)": job("reelay"),
            "moonlight": job("moonlight"),
            "rtamt (n = 10,000)": job("rtamt", 10_000),
        }
    )
    section = Section("always[0, 1000], one trace, n = 100,000")
    notes = agreement(figures) | {"stlrom, all samples, loaded": "one value: eventually always[0, 1000]"}
    section.contest(figures, notes=notes)
    values, lists, ready = "stlspec, and .signal of it", "stlspec, from lists", "mstlo, pairs ready, nothing taken out"
    section.goals = [
        faster("times faster than mstlo, arrays, values out on both sides", figures, "mstlo", 100, values),
        faster("times faster than mstlo, arrays, no values out on either side", figures, ready, 100),
        faster("times faster than RTAMT, arrays, values out", figures, "rtamt (n = 10,000)", 1000, values),
        faster("times faster than mstlo, lists, values out on both sides", figures, "mstlo", 15, lists),
        faster("times faster than mstlo, lists here, pairs ready there", figures, ready, 15, lists),
    ]
    return section


def _whole(data, tool, formula, n):
    """Make a tool that gives one value look at every sample."""
    op = "F" if formula[0] == "G" else "G"
    return data.job(tool, "trace", [[op, [0, n], formula]], data.short, n)


def until(arena, data):
    """Timed until, w = 10 and 1000: one trace, and a batch of 1000 x 1000."""
    sections = []
    own = {}
    for w in (10, 1000):
        n, formula = 100_000, ["U", [0, w], P, Q]
        jobs = {
            "stlspec": data.job("stlspec", "trace", [formula], data.short, n),
            "stlrom, value at 0, loaded": data.job("stlrom", "trace", [formula], data.short, n),
            "stlrom, all samples, loaded": _whole(data, "stlrom", formula, n),
            "mstlo": data.job("mstlo", "trace", [formula], data.short, 100_000 if w == 10 else 20_000),
            "moonlight": data.job("moonlight", "trace", [formula], data.short, n),
        }
        if w == 10:
            jobs["rtamt (n = 10,000)"] = data.job("rtamt", "trace", [formula], data.short, 10_000)
        figures = arena.contest(jobs)
        section = Section(f"until[0, {w}], one trace, n = 100,000")
        section.contest(figures, notes=agreement(figures) | {"stlrom, all samples, loaded": "one value: always until"})
        section.goals = [
            faster("times faster than STLRom's value at sample 0", figures, "stlrom, value at 0, loaded", 1)
        ]
        own[w] = figures["stlspec"].median
        sections.append(section)
    sections[-1].goals.append(Goal("w = 1000 over w = 10", own[1000] / own[10], 4, at_least=False))
    traces = 50 if arena.quick else 200
    formula = [["U", [0, 100], P, Q]]
    figures = arena.contest(
        {
            "stlspec": data.job("stlspec", "batch", formula, data.batch, 1000),
            "stlrom, loaded": data.job("stlrom", "batch", formula, data.batch, 1000, traces=traces),
            "stlrom, loading": data.job("stlrom", "loading", formula, data.batch, 1000, traces=traces),
            "mstlo": data.job("mstlo", "batch", formula, data.batch, 1000, traces=20),
        }
    )
    section = Section("until[0, 100], 1000 traces x 1000 samples")
    section.contest(figures, notes=agreement(figures))
    section.goals = [faster("times faster than STLRom, samples loaded before", figures, "stlrom, loaded", 5)]
    return [*sections, section]


def batch(arena, data):
    """The whole spec of eight requirements over 1000 x 1000 samples."""
    few = 5 if arena.quick else 20

    def job(tool, kind="batch", traces=few):
        return data.job(tool, kind, EIGHT, data.batch, 1000, traces=traces)

    figures = arena.contest(
        {
            "stlspec": job("stlspec"),
            "stlrom, loaded": job("stlrom", traces=10 * few),
            "stlrom, loading": job("stlrom", "loading", traces=10 * few),
            "mstlo": job("mstlo"),
            "moonlight": job("moonlight"),
            "rtamt": job("rtamt", traces=1),
        }
    )
    section = Section("8 requirements that share sub-formulas, 1000 traces x 1000 samples")
    section.contest(figures, notes=agreement(figures))
    peers = {label: f for label, f in figures.items() if label not in ("stlspec", "stlrom, loaded") and f.median}
    best = min(peers, key=lambda label: peers[label].median, default="stlrom, loading")
    own = figures["stlspec"]
    section.goals = [
        Goal("M samples/s", 1e-6 / own.median, 16, least=1e-6 / own.most, most=1e-6 / own.least),
        faster(f"times faster than the best that takes its samples in ({best})", figures, best, 70),
    ]
    return section


SIZES = (10**4, 10**5, 10**6, 10**7)
WIDTHS = (10, 100, 1000, 10_000)


def passes(arena, data):
    """One always and one until in passes over memory: n from 1e4 to 1e7, w from 10 to 10,000."""
    sizes = SIZES[:-1] if arena.quick else SIZES
    sections = []
    for name, formula in (("always", lambda w: ["G", [0, w], P]), ("until", lambda w: ["U", [0, w], P, Q])):
        section = Section(f"{name}[0, w], one trace, in passes of np.minimum over the same n")
        by_size = {n: _in_passes(arena, data, n, 1000, formula, section) for n in sizes}
        by_width = {w: _in_passes(arena, data, 10**6, w, formula, section) for w in WIDTHS if w != 1000}
        by_width[1000] = by_size[10**6]
        if name == "always":
            own, one = by_size[10**6]
            section.goals.append(_ratio_goal("passes at n = 1e+06, w = 1000", own, one, 8))
        section.goals.append(
            Goal("exponent in n of the number of passes, w = 1000", exponent(by_size), 0.1, at_least=False)
        )
        slowest, fastest = (pick((own for own, _ in by_width.values()), key=_median) for pick in (max, min))
        section.goals.append(_ratio_goal("slowest over fastest w, 10 to 10,000, n = 1e6", slowest, fastest, 4))
        section.goals.append(_operations(arena, data, formula, section))
        sections.append(section)
    return sections


def exponent(by_size):
    """Return p of the least squares fit of passes = c * n ** p, given {n: (own figure, figure of one pass)}."""
    counted = [own.median / one.median for own, one in by_size.values()]
    return float(np.polyfit(np.log([float(n) for n in by_size]), np.log(counted), 1)[0])


def _median(figure):
    return figure.median


def _ratio_goal(text, figure, other, bound):
    """Return the goal that a figure is at most `bound` times another."""
    ratio, least, most = figure.median / other.median, figure.least / other.most, figure.most / other.least
    return Goal(text, ratio, bound, False, least, most)


def _in_passes(arena, data, n, w, formula, section):
    """Add a row; return the figures of an evaluation and of one pass."""
    figures = arena.contest(
        {
            "evaluate": data.job("stlspec", "trace", [formula(w)], data.long, n),
            "pass": data.job("stlspec", "minimum", [], data.long, n),
        }
    )
    own, one = figures["evaluate"], figures["pass"]
    note = f"{own.median / one.median:.1f} passes (a pass: {1e-6 / one.median:.4g} M samples/s)"
    section.rows.append(Row(f"n = {n:.0e}, w = {w}", own, note=note))
    return own, one


def _operations(arena, data, formula, section):
    """Note how many operations of numpy on single elements an evaluation makes; return the goal on their spread."""
    n, counted = 10**6, {}
    for w in WIDTHS:
        (counted[w],) = arena.values(*data.job("stlspec", "operations", [formula(w)], data.long, n))
    shown = ", ".join(f"{count:.1f} (w = {w})" for w, count in counted.items())
    section.notes.append(f"element operations of ufuncs a sample, n = 1e6: {shown}")
    spread = max(counted.values()) / min(counted.values())
    return Goal("most over fewest element operations, w = 10 to 10,000, n = 1e6", spread, 4, at_least=False)


def memory(arena, data):
    """What one call allocates at its peak, eight requirements, n = 1e6."""
    n = 10**6
    section = Section("peak memory of one call, 8 requirements, n = 1e6, in arrays of n doubles")
    peak, kept = arena.values(*data.job("stlspec", "memory", EIGHT, data.long, n))
    section.notes = [f"of which {kept:.1f} are in the result (8 of them the values at every sample)"]
    section.goals = [Goal("arrays at the peak, first call of the process", peak, 12, at_least=False)]
    return section
