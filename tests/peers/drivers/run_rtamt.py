"""Answers with RTAMT, discrete time, offline."""

import rtamt
from protocol import serve


def evaluate(formula, signals, times):
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in signals:
        spec.declare_var(name, "float")
    spec.spec = formula
    spec.parse()
    return spec.evaluate({"time": times, **signals})


serve("rtamt", evaluate)
