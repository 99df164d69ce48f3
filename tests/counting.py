"""Count what numpy computes: the element operations of the ufuncs that some modules call.

In: modules that call numpy as `np`. Out: how many elements their ufuncs have written, `reduce` and `accumulate`
counted by what they read. This is the work that a clock cannot tell from what else the machine does; copies and
look-ups of elements are not in it.
"""

from contextlib import contextmanager

import numpy as np


class Counter:
    """How many element operations there have been, over all ufuncs."""

    def __init__(self):
        self.operations = 0


class _Counted:
    """A ufunc that tells a counter how much it computes."""

    def __init__(self, ufunc, counter):
        self._ufunc, self._counter = ufunc, counter

    def __call__(self, *operands, **named):
        result = self._ufunc(*operands, **named)
        self._counter.operations += np.size(result)
        return result

    def reduce(self, values, *more, **named):
        self._counter.operations += np.size(values)
        return self._ufunc.reduce(values, *more, **named)

    def accumulate(self, values, *more, **named):
        self._counter.operations += np.size(values)
        return self._ufunc.accumulate(values, *more, **named)


class _Numpy:
    """Stands for the module numpy; its ufuncs are one object each, since kernels compare them by identity."""

    def __init__(self, counter):
        self._counter = counter

    def __getattr__(self, name):
        found = getattr(np, name)
        if isinstance(found, np.ufunc):
            found = _Counted(found, self._counter)
        setattr(self, name, found)
        return found


@contextmanager
def counting(*modules):
    """Count the operations of some modules; yields the `Counter`."""
    counter = Counter()
    stand_in = _Numpy(counter)
    for module in modules:
        module.np = stand_in
    try:
        yield counter
    finally:
        for module in modules:
            module.np = np
