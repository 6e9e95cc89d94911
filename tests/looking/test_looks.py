"""Looks turn images and turn back what is found in them."""

import numpy as np
import pytest

from trecsim.estimators.decode import detections
from trecsim.estimators.looks import Look

WIDTH, HEIGHT = 7, 5


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_what_is_found_in_a_turned_image_is_put_back_where_it_is(turns):
    image = np.arange(HEIGHT * WIDTH * 3, dtype=np.uint8).reshape(HEIGHT, WIDTH, 3)
    look = Look(64, turns)
    turned = look.turned(image)
    for x, y in [(0, 0), (6, 4), (2, 3)]:
        ((row, column),) = np.argwhere((turned == image[y, x]).all(axis=2))
        box_px = np.array([[column - 0.5, row - 0.5, column + 0.5, row + 0.5]])
        found = detections(
            np.full((1, 17, 2), [column, row], float), np.ones((1, 17)), np.ones(1), box_px
        )
        back = look.turned_back(found, (WIDTH, HEIGHT))
        np.testing.assert_array_equal(back.xy_px[0, 0], [x, y])
        np.testing.assert_array_equal(back.box_px[0], [x - 0.5, y - 0.5, x + 0.5, y + 0.5])
