"""Key points at given stamps, beside a slow, obvious twin; and cameras at other moments."""

import numpy as np
import pytest

from trecsim.calibrating.people.kernels.sampling import sample
from trecsim.calibrating.people.tuning import WINDOW_S

FPS = 25.0


def sampled(t_s, xy, stamps_s):
    place, speed = (np.empty((len(stamps_s), xy.shape[1], 2)) for _ in range(2))
    sample(t_s, xy, np.full(len(t_s), 2.0), stamps_s, place, speed)
    return place, speed


def test_a_sample_is_the_weighted_line_through_the_images_near_in_time():
    rng = np.random.default_rng(0)
    t_s = np.sort(rng.uniform(0.0, 2.0, 60))
    xy = rng.normal(0.0, 0.02, (60, 1, 2)) + np.array([0.3, -0.2])
    at_s = 0.83
    place, speed = sampled(t_s, xy, np.array([at_s]))
    near = np.abs(t_s - at_s) < WINDOW_S
    weight = np.sqrt(1.0 - ((t_s[near] - at_s) / WINDOW_S) ** 2)
    A = np.stack((np.ones(near.sum()), t_s[near] - at_s), axis=1) * weight[:, None]
    for axis in range(2):
        line = np.linalg.lstsq(A, xy[near, 0, axis] * weight, rcond=None)[0]
        assert place[0, 0, axis] == pytest.approx(line[0], rel=1e-9)
        assert speed[0, 0, axis] == pytest.approx(line[1], rel=1e-9)


def test_cameras_that_take_their_images_at_other_moments_agree_on_a_swinging_ankle():
    """An ankle that swings by 0.4 m at 1.8 Hz; lines with equal weights differ by 45 mm."""

    def seen(phase_s):
        t_s = np.arange(0.0, 6.0, 1.0 / FPS) + phase_s
        way = 0.4 * np.sin(2.0 * np.pi * 1.8 * t_s)
        xy = np.repeat(way[:, None, None], 2, axis=2) / 5.0
        return sampled(t_s, xy, np.arange(1.0, 5.0, 0.2))[0]

    places = np.array([seen(phase_s) for phase_s in np.linspace(0.0, 0.039, 8)])
    assert 5.0 * np.ptp(places, axis=0).max() < 0.01


def test_without_two_images_nothing_is_known():
    place, _ = sampled(np.array([0.0, 1.0]), np.zeros((2, 1, 2)), np.array([0.0, 5.0]))
    assert np.isnan(place).all()
