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


def passes(arena, data):
    """One always in passes over memory: n from 1e4 to 1e7, w from 10 to 10,000."""
    section = Section("always[0, w], one trace, in passes of np.minimum over the same n")
    sizes = (10**4, 10**5, 10**6) if arena.quick else (10**4, 10**5, 10**6, 10**7)
    seconds = {}
    for n in sizes:
        taken, counted = _in_passes(arena, data, n, 1000, section)
        seconds[n] = taken * n
        if n == 10**6:
            section.goals.append(counted)
    large = [n for n in sizes if n >= 10**5]
    slope = np.polyfit(np.log([float(n) for n in large]), np.log([seconds[n] for n in large]), 1)[0]
    section.notes.append(f"time grows with n to the power of {slope:.2f} (from n = 1e5 on)")
    widths = {w: _in_passes(arena, data, 10**6, w, section)[0] for w in (10, 100, 10_000)}
    widths[1000] = seconds[10**6] / 10**6
    spread = max(widths.values()) / min(widths.values())
    section.goals.append(Goal("slowest over fastest w, 10 to 10,000, n = 1e6", spread, 4, at_least=False))
    return section


def _in_passes(arena, data, n, w, section):
    """Add a row; return seconds a sample and the goal for the number of passes."""
    figures = arena.contest(
        {
            "evaluate": data.job("stlspec", "trace", [["G", [0, w], P]], data.long, n),
            "pass": data.job("stlspec", "minimum", [], data.long, n),
        }
    )
    own, one = figures["evaluate"], figures["pass"]
    counted = own.median / one.median
    note = f"{counted:.1f} passes (a pass: {1e-6 / one.median:.4g} M samples/s)"
    section.rows.append(Row(f"n = {n:.0e}, w = {w}", own, note=note))
    text = f"passes at n = {n:.0e}, w = {w}"
    return own.median, Goal(text, counted, 8, False, own.least / one.most, own.most / one.least)


def memory(arena, data):
    """What one call allocates at its peak, eight requirements, n = 1e6."""
    n = 10**6
    section = Section("peak memory of one call, 8 requirements, n = 1e6, in arrays of n doubles")
    peak, kept = arena.values(*data.job("stlspec", "memory", EIGHT, data.long, n))
    section.notes = [f"peak {peak:.1f}, of which {kept:.1f} are in the result (8 of them the values at every sample)"]
    return section
