"""Whatever holds numbers becomes a fresh column of float64, time along the first axis."""

import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

from stlspec.columns import first_true, snapped, to_column, unmasked
from stlspec.errors import DataError


@pytest.mark.parametrize(
    "values", [[2**53 + 1, 0.5], [2**70, True], [1, -(2**63)], [0.1, Fraction(1, 3), np.float32(0.1), np.int8(3)]]
)
def test_a_list_has_the_values_that_its_numbers_have_one_by_one(values):
    assert to_column("x", values, None).tolist() == [float(v) for v in values]


@pytest.mark.parametrize("batch", [[[1, 2, 3], [4, 5, 6]], np.arange(1, 7).reshape(2, 3), [np.arange(1, 4), (4, 5, 6)]])
def test_a_batch_is_turned_to_have_time_first(batch):
    found = to_column("x", batch, None)
    assert found.tolist() == [[1, 4], [2, 5], [3, 6]]
    assert found.flags.c_contiguous
    assert found.flags.writeable


def test_a_column_is_a_copy():
    values = np.ones(3)
    assert not np.shares_memory(to_column("x", values, None), values)


@pytest.mark.parametrize(
    ("values", "code"),
    [
        (1.0, "D813"),
        ([[[1.0]]], "D813"),
        ([[1.0], [1.0, 2.0]], "D813"),
        ([1.0, [2.0]], "D813"),
        ([1.0, "2"], "D806"),
        ([1.0, 2j], "D806"),
        ([1.0, np.complex128(2j)], "D806"),
        ([np.complex64(1)], "D806"),
    ],
)
def test_what_is_no_column_is_refused(values, code):
    with pytest.raises(DataError) as caught:
        to_column("x", values, None)
    assert caught.value.diagnostics[0].code == code


def test_masked_samples_are_nan_in_arrays_and_in_rows():
    masked = np.ma.masked_greater([1, 2, 3], 2)
    assert np.isnan(unmasked(masked)).tolist() == [False, False, True]
    assert np.isnan(unmasked([masked, masked])).tolist() == [[False, False, True]] * 2
    assert unmasked([1.0, 2.0]) == [1.0, 2.0]


def test_masked_arrays_are_not_imported_for_the_sake_of_others():
    script = "import sys, stlspec\nb = stlspec.compile('signal x\\nhard a: x > 0\\n')\nb.evaluate({'x': [1.0]})\n"
    script += "sys.exit('numpy.ma' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_the_first_true_is_the_earliest_sample():
    assert first_true(np.array([[False, False], [False, True], [True, False]])) == (1, 1)


def test_a_bound_as_32_bits_have_it_is_the_bound():
    values = np.array(
        [np.float32(-1.2), -1.2, 0.5, np.float32(0.07), np.nextafter(np.float32(0.07), np.float32(1))], float
    )
    snapped(values, -1.2, 0.07)
    assert values[:2].tolist() == [-1.2, -1.2] and values[3] == 0.07
    assert values[2] == 0.5 and values[4] > 0.07  # beyond by more than rounding
    unbounded = np.array([1e300, np.inf])
    snapped(unbounded, -np.inf, np.inf)
    assert unbounded.tolist() == [1e300, np.inf]
