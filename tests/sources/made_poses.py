"""2D poses for the tests of their files."""

import numpy as np

from trecsim.values import Poses2D


def made_poses(camera: str, t_s: float, n_people: int, seed: int = 0) -> Poses2D:
    """Return random people whose numbers survive the rounding of files; some joints missing."""
    rng = np.random.default_rng(seed)
    xy_px = rng.integers(-10_000, 200_000, (n_people, 17, 2)) / 100.0
    score = rng.integers(1, 1000, (n_people, 17)) / 1000.0
    missing = rng.random((n_people, 17)) < 0.2
    xy_px[missing], score[missing] = np.nan, 0.0
    return Poses2D(camera, t_s, xy_px, score, rng.integers(0, 1001, n_people) / 1000.0)


def assert_same(found: Poses2D, expected: Poses2D) -> None:
    """Compare two images field by field."""
    assert (found.camera, found.t_s) == (expected.camera, expected.t_s)
    np.testing.assert_array_equal(found.xy_px, expected.xy_px)
    np.testing.assert_array_equal(found.score, expected.score)
    np.testing.assert_array_equal(found.person_score, expected.person_score)
    assert found.xy_px.flags.c_contiguous
    assert found.score.flags.c_contiguous
    assert {found.xy_px.dtype, found.score.dtype, found.person_score.dtype} == {np.dtype(float)}
