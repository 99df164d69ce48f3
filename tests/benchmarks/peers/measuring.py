"""Timing that every contestant shares: CPU seconds of one call, on a clock that is fine enough.

Runs in the process of each tool and uses the standard library only.
"""

import math
import resource
import time

COARSEST = 1e-4
"""The largest step of the process clock that is accepted, in seconds."""


class CoarseClockError(Exception):
    """The clock of this process cannot time anything; says why and what to do."""


def process_step(now=time.process_time, steps=5, longest=0.2):
    """Return the smallest step, in seconds, that the process clock is seen to make."""
    smallest, seen, begin = math.inf, 0, time.perf_counter()
    last = now()
    while seen < steps and time.perf_counter() - begin < longest:
        current = now()
        if current != last:
            smallest, seen, last = min(smallest, current - last), seen + 1, current
    return smallest


def check_clock(now=time.process_time, limits=resource.getrlimit):
    """Return the step of the process clock in seconds.

    Raises: CoarseClockError: there is a CPU limit, under which the kernel counts in ticks, or it is coarse anyway.
    """
    soft, _ = limits(resource.RLIMIT_CPU)
    if soft != resource.RLIM_INFINITY:
        raise CoarseClockError(
            f"there is a CPU limit of {soft} s, under which the process clock ticks in steps of 4 ms: "
            "run without `ulimit -t`"
        )
    step = process_step(now)
    if step > COARSEST:
        raise CoarseClockError(f"the process clock ticks in steps of {step * 1e3:.3g} ms: nothing can be timed with it")
    if time.get_clock_info("perf_counter").resolution > 1e-6:
        raise CoarseClockError("perf_counter is coarser than a microsecond")
    return step


def seconds_a_call(call, at_least, now=time.process_time):
    """Return the CPU seconds of one call, from as many calls as take `at_least` seconds together."""
    calls, total, batch = 0, 0.0, 1
    while not calls or total < at_least:
        begin = now()
        for _ in range(batch):
            call()
        elapsed = now() - begin
        calls, total = calls + batch, total + elapsed
        missing = (at_least - total) / max(elapsed / batch, 1e-9)
        batch = max(1, min(int(missing) + 1, 10 * batch))
    return total / calls


def quantiles(call, count, wanted, now=time.perf_counter_ns):
    """Return quantiles, in seconds, of single calls by the wall clock, its own cost taken off."""
    empty = sorted(-now() + now() for _ in range(2000))[1000]
    found = []
    for _ in range(count):
        begin = now()
        call()
        found.append(now() - begin)
    found.sort()
    return [max(found[min(count - 1, int(q * count))] - empty, 0) / 1e9 for q in wanted]
