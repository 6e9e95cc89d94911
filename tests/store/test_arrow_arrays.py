"""Columns of Arrow become arrays, also those that other programs wrote."""

import numpy as np
import pyarrow as pa

from trecsim.store.arrow_arrays import filled, numbers_of


def test_a_missing_number_is_nan() -> None:
    column = pa.chunked_array([[0.5, None], [2.5]])
    np.testing.assert_array_equal(numbers_of(column), [0.5, np.nan, 2.5])
    np.testing.assert_array_equal(numbers_of(pa.array([3, None])), [3.0, np.nan])


def test_a_column_of_nulls_without_a_type_is_filled() -> None:
    np.testing.assert_array_equal(filled(pa.chunked_array([pa.nulls(2)]), -1), [-1, -1])
