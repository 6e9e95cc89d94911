"""Turns and clocks that the tracker has learnt are told once, when they are clear and last."""

import numpy as np

from fusion.somebody import MODEL
from trecsim.consistency.learnt_errors import LearntErrors, clock_delays_s
from trecsim.fusion.camera_errors import CameraErrors

NAMES = MODEL.rig.names


def learnt(turn_deg=0.0, late_s=0.0, sigma=1e-4):
    """Return what is learnt where the second camera has these errors, and how surely."""
    errors = CameraErrors(MODEL.rig)
    errors.found[1, 0], errors.found[1, 3] = np.radians(turn_deg), late_s
    errors.variance[:] = sigma**2
    return errors


def said(errors, until_s=15.0):
    watch = LearntErrors(NAMES)
    return [
        (t_s, text) for t_s in np.arange(0.0, until_s, 0.04) for text in watch.observe(t_s, errors)
    ]


def test_a_turn_is_told_once_after_it_has_been_clear_for_some_seconds():
    ((t_s, text),) = said(learnt(turn_deg=0.5))
    assert 5.0 < t_s < 7.0
    assert f"camera {NAMES[1]!r}" in text
    assert "0.5 degrees" in text


def test_a_late_clock_is_told_with_the_entry_that_corrects_it():
    ((_, text),) = said(learnt(late_s=0.03))
    assert f"clock of camera {NAMES[1]!r}" in text
    assert "30 ms late" in text
    assert "time_offset_s = -0.030" in text
    assert "20 ms early" in said(learnt(late_s=-0.02))[0][1]


def test_small_and_unsure_errors_are_not_told():
    assert not said(learnt(turn_deg=0.1, late_s=0.005))
    assert not said(learnt(turn_deg=0.5, late_s=0.03, sigma=0.01))


def test_errors_that_go_away_are_not_told():
    watch, errors = LearntErrors(NAMES), learnt(turn_deg=0.5)
    found = [text for t_s in np.arange(0.0, 3.0, 0.04) for text in watch.observe(t_s, errors)]
    found += [text for t_s in np.arange(3.0, 15.0, 0.04) for text in watch.observe(t_s, learnt())]
    assert not found


def test_at_the_end_of_a_short_run_what_is_clear_is_told():
    watch, errors = LearntErrors(NAMES), learnt(turn_deg=0.5)
    assert not watch.observe(0.0, errors)
    assert len(watch.end(errors)) == 1
    assert not watch.end(errors)


def test_how_late_a_clock_is_is_said_from_when_on_it_is_known():
    assert clock_delays_s(NAMES, learnt(late_s=0.03, sigma=0.002))[NAMES[1]] == 0.03
    assert clock_delays_s(NAMES, learnt(late_s=0.02, sigma=0.01)) == {}
    assert list(clock_delays_s(NAMES, learnt(late_s=0.04, sigma=0.01))) == [NAMES[1]]
