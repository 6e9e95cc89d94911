"""What is done to tracks before they are written: a rate, gaps, smoothing."""

from pathlib import Path

import numpy as np
import pytest
from scipy import interpolate, signal

from made_motion import RATE_HZ, exported, recorded, two_walkers, walking_m
from trecsim.errors import InputError
from trecsim.export.cubic import cubic_through
from trecsim.export.fixed_rate import resampled, usual_rate_hz
from trecsim.export.motions import collect
from trecsim.export.smoothing import Smoothing, butterworth, local_parabola
from trecsim.store.tracks import read_tracks


def sway_m(t_s: np.ndarray) -> np.ndarray:
    """Return a person whose joints all sway at 1 and 2 Hz, by up to 0.3 m."""
    xyz_m = walking_m(t_s) * 0.0
    xyz_m[..., 0] = 0.3 * np.sin(2 * np.pi * t_s)[:, None]
    xyz_m[..., 1] = 0.1 * np.cos(4 * np.pi * t_s)[:, None]
    return xyz_m


def test_the_spline_is_that_of_scipy_away_from_its_ends() -> None:
    rng = np.random.default_rng(1)
    t_s = np.cumsum(rng.uniform(0.02, 0.06, 60))
    values = rng.normal(size=(60, 4))
    at_s = np.linspace(t_s[20], t_s[40], 300)
    reference = interpolate.CubicSpline(t_s, values)(at_s)
    np.testing.assert_allclose(cubic_through(t_s, values, at_s), reference, atol=1e-9)


def test_a_movement_at_another_rate_is_the_same_movement(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    t_s = np.sort(np.arange(100) / RATE_HZ + rng.uniform(-0.008, 0.008, 100))
    tracks = recorded(tmp_path / "t.csv", {0: sway_m(t_s)}, t_s)
    motion = resampled(collect(read_tracks(tracks)), 60.0)
    (one,) = motion.people
    np.testing.assert_allclose(np.diff(one.t_s), 1 / 60)
    assert one.t_s[0] == t_s[0]
    inner = slice(10, -10)
    np.testing.assert_allclose(one.xyz_m[inner], sway_m(one.t_s)[inner], atol=4e-4)


@pytest.mark.parametrize(("rate_hz", "digits"), [(30.0, 3), (25.0, 3), (29.97, 6), (7.5, 3)])
def test_the_usual_rate_is_found_from_rounded_times(
    rate_hz: float, digits: int, tmp_path: Path
) -> None:
    t_s = np.round(5.0 + np.arange(300) / rate_hz, digits)
    t_s = np.delete(t_s, [40, 41, 42, 100])
    tracks = recorded(tmp_path / "t.csv", {0: walking_m(t_s)}, t_s)
    assert usual_rate_hz(collect(read_tracks(tracks))) == pytest.approx(rate_hz, rel=1e-5)


def test_a_gap_stays_a_gap_unless_it_is_to_be_filled(tmp_path: Path) -> None:
    tracks, t_s, people = two_walkers(tmp_path)
    there = np.isfinite(people[7]).any(axis=(1, 2))
    motion = collect(read_tracks(tracks), person=7)
    (one,) = resampled(motion, RATE_HZ).people
    np.testing.assert_array_equal(one.present, there)
    (still,) = resampled(motion, RATE_HZ, fill_s=0.9).people
    np.testing.assert_array_equal(still.present, there)
    (full,) = resampled(motion, RATE_HZ, fill_s=1.1).people
    assert full.present.all()
    truth = walking_m(t_s, 1)
    np.testing.assert_allclose(full.xyz_m[there], truth[there], atol=1e-5)
    assert (full.support[~there] == 0).all()
    assert np.abs(full.xyz_m[~there, 0, 0] - truth[~there, 0, 0]).max() < 0.05


def test_gaps_are_filled_at_the_recorded_times_where_no_rate_is_asked_for(tmp_path: Path) -> None:
    tracks, t_s, _ = two_walkers(tmp_path)
    (file,) = exported(tracks, tmp_path / "f.csv", fill_s=2.0).files
    seven = [one.t_s for one in read_tracks(file) if 7 in one.id]
    assert seven == t_s.tolist()


def test_butterworth_is_that_of_scipy_in_both_directions() -> None:
    rng = np.random.default_rng(3)
    values = np.cumsum(rng.normal(size=(400, 3)), axis=0)
    corner = 6.0 / (np.sqrt(2.0) - 1.0) ** 0.25
    b, a = signal.butter(2, corner, fs=100.0)
    reference = signal.filtfilt(b, a, values, axis=0)
    np.testing.assert_allclose(butterworth(values, 0.06)[40:-40], reference[40:-40], atol=1e-3)


def test_butterworth_leaves_what_it_says_at_its_cut_off_and_shifts_nothing() -> None:
    t_s = np.arange(2000) / 100.0
    wave = np.sin(2 * np.pi * 6.0 * t_s)[:, None]
    left = butterworth(wave, 0.06)[500:1500, 0]
    np.testing.assert_allclose(left, wave[500:1500, 0] * np.sqrt(0.5), atol=0.01)


def test_the_local_parabola_is_that_of_scipy() -> None:
    values = np.random.default_rng(4).normal(size=(60, 3))
    reference = signal.savgol_filter(values, 11, 2, axis=0)
    np.testing.assert_allclose(local_parabola(values, 5), reference, atol=1e-12)


def test_smoothing_makes_noise_smaller_and_says_its_name_and_phase(tmp_path: Path) -> None:
    t_s = np.arange(200) / 30.0
    rng = np.random.default_rng(6)
    noise_m = rng.normal(0.0, 0.01, (200, 17, 3))
    tracks = recorded(tmp_path / "n.csv", {0: sway_m(t_s) + noise_m}, t_s)
    for smoothing in (Smoothing(lag_s=0.1), Smoothing(butterworth_hz=5.0)):
        done = exported(tracks, tmp_path / "s.csv", smoothing)
        assert "zero phase" in done.smoothing
        found = np.array([one.xyz_m[0] for one in read_tracks(done.files[0])])
        inner = slice(20, -20)
        error_m = (found - sway_m(t_s))[inner]
        assert np.sqrt(np.mean(error_m**2)) < 0.7 * 0.01


@pytest.mark.parametrize(
    ("smoothing", "text"),
    [
        (Smoothing(butterworth_hz=20.0), "less than 10"),
        (Smoothing(lag_s=0.001), "one frame"),
        (Smoothing(lag_s=0.2, butterworth_hz=6.0), "not both"),
    ],
)
def test_smoothing_that_is_not_possible_is_refused(
    smoothing: Smoothing, text: str, tmp_path: Path
) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(InputError, match=text):
        exported(tracks, tmp_path / "o.trc", smoothing)
    assert sorted(tmp_path.iterdir()) == [tracks]
