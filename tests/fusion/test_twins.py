"""What an estimator finds twice in an image counts once."""

import numpy as np
import pytest

import reference_fusion as reference
from fusion.made import NOISE, frame_sets, made, outcome, path
from fusion.somebody import MODEL
from trecsim.fusion import Tracker
from trecsim.fusion.images import prepare
from trecsim.fusion.kernels.prefilter import suppress_duplicates
from trecsim.values import FrameSet, Poses2D


@pytest.mark.parametrize("seed", range(20))
def test_twins_are_found_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    people = rng.uniform(0, 300, (4, 17, 2))
    xy_px = people[rng.integers(4, size=12)] + rng.normal(0, rng.uniform(0.5, 3.0), (12, 17, 2))
    xy_px[rng.random((12, 17)) < 0.3] = np.nan
    xy_px[rng.integers(12)] = np.nan
    factor = rng.uniform(1.0, 6.0, (12, 17))
    offset = np.array([0, 5, 5, 12])
    expected = reference.stays_of_twins(offset, xy_px, factor)
    found = np.isfinite(xy_px[..., 0]).any(axis=1)
    left = suppress_duplicates(offset, xy_px, factor)
    np.testing.assert_array_equal(np.isfinite(xy_px[..., 0]).any(axis=1), expected)
    assert len(found) - left == found.sum() - expected.sum()


def test_the_better_of_two_twins_stays():
    rng = np.random.default_rng(0)
    xy = np.repeat(rng.uniform(100, 500, (1, 17, 2)), 3, axis=0)
    score = np.full((3, 17), 0.5)
    score[1] = 0.8
    images = prepare([Poses2D(MODEL.rig.names[0], 0.0, xy, score, np.ones(3))], MODEL)
    assert images.offset.tolist() == [0, 1]
    assert (images.sigma_scale < 1.2).all()


def test_the_same_person_in_two_images_is_no_twin():
    xy = np.random.default_rng(0).uniform(100, 500, (1, 17, 2))
    views = [Poses2D(name, 0.0, xy, np.ones((1, 17)), np.ones(1)) for name in MODEL.rig.names]
    assert len(prepare(views, MODEL).xy_px) == len(views)


@pytest.mark.parametrize("times", [2, 50])
def test_people_found_many_times_over_are_as_many_as_they_are(times):
    scene = made([path((0, -2, 0), (6, 2, 0)), path((0, -2, 1.5), (6, 2, 1.5))], detector=NOISE)

    def follow(count):
        tracker = Tracker(scene.rig)
        return [tracker.step(_repeated(s, count)) for s in frame_sets(scene)[:75]]

    once, often = follow(1), follow(times)
    assert outcome(scene, often).ids == {0, 1}
    for one, other in zip(once, often, strict=True):
        np.testing.assert_array_equal(one.id, other.id)
        np.testing.assert_allclose(one.xyz_m, other.xyz_m, atol=1e-9)


def _repeated(frame_set, times):
    return FrameSet(
        frame_set.t_s,
        tuple(
            Poses2D(
                v.camera,
                v.t_s,
                np.repeat(v.xy_px, times, axis=0),
                np.repeat(v.score, times, axis=0),
                np.repeat(v.person_score, times),
            )
            for v in frame_set.views
        ),
    )
