"""Noise is no movement; somebody small is."""

import numpy as np
import pytest

from made_videos import write_video
from trecsim.looking.stillness import blocks, has_moved
from trecsim.sources import VideoFile

SHAPE = (720, 1280)


def noisy(seed, sigma=5.0):
    rng = np.random.default_rng(seed)
    return np.clip(rng.normal(100.0, sigma, SHAPE), 0, 255).astype(np.uint8)


def test_noise_of_a_camera_is_no_movement():
    assert not has_moved(blocks(noisy(1)), blocks(noisy(2)))


@pytest.mark.parametrize("place", [(0, 0), (350, 601), (700, 1260)])
def test_somebody_of_20_pixels_is(place):
    image = noisy(1)
    row, column = place
    image[row : row + 20, column : column + 20] += 60
    assert has_moved(blocks(image), blocks(noisy(2)))


def test_the_first_image_and_one_of_another_size_count_as_moved():
    assert has_moved(blocks(noisy(1)), None)
    assert has_moved(blocks(noisy(1)), blocks(noisy(1)[:300]))
    assert not has_moved(blocks(np.full((5, 5), 7, np.uint8)), blocks(np.full((5, 5), 8, np.uint8)))


@pytest.mark.parametrize("pix_fmt", ["yuv420p", "yuv422p10le", "gray", "gray10le", "bgr0"])
def test_movement_is_seen_anywhere_in_images_of_any_kind(tmp_path, pix_fmt):
    image = np.full((48, 64, 3), 60, np.uint8)
    moved = image.copy()
    moved[16:32, 48:] = 200  # at the right
    path = write_video(tmp_path / "v.mkv", [image, moved, image], codec="ffv1", pix_fmt=pix_fmt)
    first, second, third = (blocks(one.brightness()) for one in VideoFile(path, "a").pictures())
    assert first.shape == (3, 4)
    assert has_moved(first, second)
    assert not has_moved(first, third)
    assert np.abs(first - 60.0).max() < 9.0  # of 16 to 235 it is 68
