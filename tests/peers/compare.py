"""Compare stlspec with independent tools on random formulas and traces.

    python tests/peers/compare.py --cases 500

Each tool gets cases from its own fragment (`fragments.py`) in its own environment and process. A case agrees
if the tool gives what `bundle.evaluate` gives, bit for bit, at every sample that the tool has a value for. A
disagreement is put to the definition (`tests/oracle.py`) and shown with whom it agrees; it makes the exit
code 1. The known faults of a tool are shown again each time, so that a fragment is never narrower than it
must be. A tool that cannot be installed is reported and skipped.
"""

import argparse
import json
import math
import random
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import stlspec
from stlspec.tools.conformance import formula_text
from tests.oracle import Oracle
from tests.peers.environments import NotInstalledError, default_work, environment
from tests.peers.fragments import FRAGMENTS, random_case
from tests.peers.syntax import WRITERS, nodes_of

DRIVERS = Path(__file__).parent / "drivers"
_SECONDS_A_CASE = 5


@dataclass
class Tally:
    """What came of the cases of one tool: how many agree, on how many samples, and those that do not."""

    version: str
    agree: int = 0
    samples: int = 0
    silent: int = 0
    differing: list = field(default_factory=list)


def own_values(case):
    """What stlspec gives at every sample, from the text of the formula on."""
    kinds = (f"signal {name}{': bool' if name == 'b' else ''}\n" for name in case.signals)
    spec = f"time s\n{''.join(kinds)}hard f: {formula_text(case.formula)}\n"
    return stlspec.compile(spec).evaluate(case.signals, case.times)["f"].signal.tolist()


def defined_values(case):
    """What the definition gives at every sample."""
    nodes, root = nodes_of(case.formula)
    return Oracle(nodes, case.signals, case.times, 1).rho(root)


def answers(env, cases, write):
    """Return the version of a tool and its answer to each case; a case that kills the process is an error."""
    lines = [json.dumps({"formula": write(c.formula), "signals": c.signals, "times": c.times}) for c in cases]
    found, version = [], ""
    while len(found) < len(lines):
        waiting = lines[len(found) :]
        try:
            seconds = 60 + _SECONDS_A_CASE * len(waiting)
            done = env.run(DRIVERS / f"run_{env.tool}.py", "\n".join(waiting) + "\n", seconds)
        except subprocess.TimeoutExpired as late:
            raise NotInstalledError(f"no answer within {late.timeout:.0f} s") from None
        out = [json.loads(line) for line in done.stdout.splitlines()]
        if not out:
            reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
            raise NotInstalledError(f"the driver does not start: {reason[:150]}")
        version = out[0]["version"]
        found += out[1:]
        if len(out) - 1 < len(waiting):
            found.append({"error": f"the process ends with exit code {done.returncode}"})
    return version, found


def judge(case, answer, tally):
    """Compare one answer with ours and count it."""
    if "error" in answer:
        tally.differing.append((case, f"error: {answer['error']}"))
        return
    ours = dict(zip(case.times, own_values(case), strict=True))
    pairs = [(t, value, ours[int(t)]) for t, value in answer["values"] if t in ours]
    wrong = [(t, theirs, own) for t, theirs, own in pairs if theirs != own]
    if wrong:
        t, theirs, own = wrong[0]
        defined = defined_values(case)[case.times.index(int(t))]
        if math.isclose(theirs, own, rel_tol=1e-12):
            side = "the last digit only"
        else:
            side = "stlspec agrees with the definition" if own == defined else "stlspec differs from the definition"
        tally.differing.append((case, f"at {t:g}: {theirs} there, {own} here, {defined} by definition: {side}"))
    elif pairs:
        tally.agree += 1
        tally.samples += len(pairs)
    else:
        tally.silent += 1


def compare(tool, cases, env):
    """Run cases through one tool; return the tally."""
    version, found = answers(env, cases, WRITERS[tool])
    tally = Tally(version)
    for case, answer in zip(cases, found, strict=True):
        judge(case, answer, tally)
    return tally


def _shown(case):
    return json.dumps({"formula": case.formula, "trace": {"t": case.times, **case.signals}})


def _report(tool, tally, n_cases):
    silent = f", {tally.silent} without a value to compare" if tally.silent else ""
    print(
        f"{tool} {tally.version}: {n_cases} cases, {tally.agree} agree ({tally.samples} samples), "
        f"{len(tally.differing)} disagree{silent}"
    )
    for case, what in tally.differing[:3]:
        print(f"  {WRITERS[tool](case.formula)}\n    {what}\n    {_shown(case)}")


def _report_faults(tool, env):
    """Show each known fault again."""
    for fault in FRAGMENTS[tool].faults:
        again = compare_fault(tool, fault, env)
        print(f"  left out: {fault.reason}; {again}")


def compare_fault(tool, fault, env):
    """Tell whether a known fault is still there."""
    _, (answer,) = answers(env, [fault.case], lambda _: fault.text)
    tally = Tally("")
    judge(fault.case, answer, tally)
    return f"seen ({tally.differing[0][1]})" if tally.differing else "NOT SEEN: widen the fragment"


def main(arguments=None):
    """Compare with every tool that installs; return 1 if there is a disagreement that is not explained."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tools", nargs="*", default=list(FRAGMENTS), choices=list(FRAGMENTS))
    parser.add_argument("--work", type=Path, default=default_work(), help="where environments are kept")
    options = parser.parse_args(arguments)
    wrong = 0
    for tool in options.tools:
        rng = random.Random(f"{options.seed} {tool}")
        cases = [random_case(FRAGMENTS[tool], rng) for _ in range(options.cases)]
        try:
            env = environment(tool, options.work)
            tally = compare(tool, cases, env)
        except NotInstalledError as error:
            print(f"{tool}: SKIPPED, {error}")
            continue
        _report(tool, tally, len(cases))
        _report_faults(tool, env)
        print(f"  no syntax for: {FRAGMENTS[tool].absent}")
        wrong += len(tally.differing)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
