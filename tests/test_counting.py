"""Operations are counted where a module makes them, and only there."""

from types import SimpleNamespace

import numpy as np

from tests.counting import counting


def test_elements_of_results_are_counted_and_of_reductions_what_they_read():
    module, other = SimpleNamespace(np=np), SimpleNamespace(np=np)
    with counting(module) as counter:
        low = module.np.minimum
        assert low is module.np.minimum
        assert low(np.ones((2, 3)), 0.0).tolist() == [[0.0] * 3] * 2
        assert counter.operations == 6
        assert low.reduce(np.arange(5.0)) == 0.0
        assert low.accumulate(np.array([2.0, 1.0, 3.0])).tolist() == [2.0, 1.0, 1.0]
        assert counter.operations == 14
        other.np.minimum(np.ones(9), 0.0)
        assert module.np.empty(4).shape == (4,)
        assert counter.operations == 14
    assert module.np is np
