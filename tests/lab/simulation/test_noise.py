"""Chance that remembers."""

import numpy as np
import pytest

from trecsim.lab.simulation.noise import ornstein_uhlenbeck, spells


def test_processes_have_unit_variance_and_the_memory_asked_for() -> None:
    t_s = np.cumsum(np.tile([0.02, 0.06], 250))
    values = ornstein_uhlenbeck(np.random.default_rng(0), t_s, 0.4, 4000)
    np.testing.assert_allclose(values.mean(axis=1), 0.0, atol=0.08)
    np.testing.assert_allclose(values.std(axis=1), 1.0, atol=0.06)
    for step in (1, 5, 10):  # 10 steps are 0.4 s
        correlation = np.mean(values[100] * values[100 + step])
        assert correlation == pytest.approx(np.exp(-(t_s[100 + step] - t_s[100]) / 0.4), abs=0.06)


def test_spells_take_their_share_of_the_time_and_last() -> None:
    t_s = np.arange(0.0, 200.0, 0.04)
    on = spells(np.random.default_rng(0), t_s, 0.3, np.array([0.05, 0.5]), 60, 2)
    np.testing.assert_allclose(on.mean(axis=(0, 1)), [0.05, 0.5], rtol=0.1)
    again = on[1:, :, 0][on[:-1, :, 0]].mean()  # still on in the next image
    assert again > 0.5


def test_shares_of_none_and_all_are_exact() -> None:
    on = spells(np.random.default_rng(0), np.arange(50.0), 1.0, np.array([0.0, 1.0]), 30, 2)
    assert not on[..., 0].any()
    assert on[..., 1].all()


def test_no_images_need_no_chance() -> None:
    assert ornstein_uhlenbeck(np.random.default_rng(0), np.empty(0), 1.0, 3).shape == (0, 3)
