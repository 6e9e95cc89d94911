"""Likelihoods of whole people, assignment and responsibilities equal their twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL, SETTINGS, seen, somebody
from trecsim.fusion import kernels

SEEDS = st.integers(0, 2**32 - 1)


def score(cam, xyz, cov, xy, factor, reach_m=np.inf, slack=None):
    out, flip = np.empty((len(xyz), len(xy))), np.empty((len(xyz), len(xy)), np.int64)
    slack = np.ones(len(xyz)) if slack is None else slack
    kernels.score_view(
        MODEL.cameras, MODEL.noise, cam, (xyz, cov, slack), (xy, factor), reach_m, (out, flip)
    )
    return out, flip


@given(SEEDS)
def test_scores_of_a_view_equal_the_sum_over_joints(seed):
    rng = np.random.default_rng(seed)
    P, focal = MODEL.cameras.P[1], MODEL.cameras.focal_px[1]
    xyz, cov = map(np.stack, zip(*[somebody(rng) for _ in range(2)], strict=True))
    xy, factor = map(np.stack, zip(*[seen(rng, P, x) for x in xyz], strict=True))
    slack = rng.uniform(1.0, 5.0, 2)
    out, flip = score(1, xyz, cov, xy, factor, slack=slack)
    for k in range(2):
        for d in range(2):
            both = [
                reference.score_pair(
                    P, focal, xyz[k], cov[k], xy[d], factor[d], MODEL.noise,
                    MODEL.cameras.error_px2[1], SETTINGS.outlier_share, SETTINGS.outlier_area_m2, f,
                    slack[k],
                )
                for f in range(2)
            ]  # fmt: skip
            assert out[k, d] == pytest.approx(max(both), rel=1e-6, abs=1e-6)
            assert flip[k, d] == np.argmax(both)


@given(SEEDS, st.floats(0.05, 1.5))
def test_only_detections_within_reach_are_scored(seed, reach_m):
    rng = np.random.default_rng(seed)
    xyz, cov = somebody(rng)
    xy, factor = seen(rng, MODEL.cameras.P[2], xyz + rng.normal(0, 0.5, 3))
    known = np.isfinite(xy[:, 0])
    uv = np.array([reference.project(MODEL.cameras.P[2], x) for x in xyz])
    depth = np.array([reference.depth(MODEL.cameras.P[2], x) for x in xyz])
    apart_m = (np.linalg.norm(xy - uv, axis=1) * depth / MODEL.cameras.focal_px[2])[known].mean()
    if abs(apart_m - reach_m) < 1e-6:
        return
    out, _ = score(2, xyz[None], cov[None], xy[None], factor[None], reach_m)
    assert np.isfinite(out[0, 0]) == (apart_m < reach_m)


def test_a_mirrored_detection_is_read_mirrored():
    rng = np.random.default_rng(1)
    xyz, cov = somebody(rng)
    xy = np.array([reference.project(MODEL.cameras.P[0], x) for x in xyz])[MODEL.noise.mirror]
    _, flip = score(0, xyz[None], cov[None] * 0.1, xy[None], np.ones((1, 17)))
    assert flip[0, 0] == 1


@given(SEEDS, st.integers(1, 6), st.integers(1, 6))
def test_assignment_reaches_the_same_gain_as_scipys(seed, n_row, n_column):
    rng = np.random.default_rng(seed)
    gain = rng.normal(1.0, 3.0, (n_row, n_column))
    best = np.empty(n_row, np.int64)
    kernels.assign(gain, best)
    used = best[best >= 0]
    assert len(set(used)) == len(used)
    rows = np.flatnonzero(best >= 0)
    expected = reference.assign(gain)
    right = np.flatnonzero(expected >= 0)
    total = gain[rows, best[rows]].sum()
    assert total == pytest.approx(gain[right, expected[right]].sum())


@given(SEEDS, st.integers(1, 6), st.integers(1, 6), st.floats(-4, 2))
def test_weighing_only_contested_claims_gains_as_much_as_weighing_all(seed, n_row, n_column, usual):
    ratio = np.random.default_rng(seed).normal(usual, 3.0, (n_row, n_column))
    best = np.empty(n_row, np.int64)
    kernels.match_view(ratio, best)
    found = np.flatnonzero(best >= 0)
    assert len(set(best[found])) == len(found)
    expected = reference.associate(ratio)
    right = np.flatnonzero(expected >= 0)
    total = ratio[found, best[found]].sum()
    assert total == pytest.approx(ratio[right, expected[right]].sum())


@given(SEEDS, st.integers(1, 4), st.integers(1, 4))
def test_responsibilities_share_a_detection_between_tracks_and_clutter(seed, n_track, n_person):
    ratio = np.random.default_rng(seed).normal(0, 20, (n_track, n_person))
    expected = reference.responsibility(ratio, 3.0)
    got = [
        [kernels.responsibility(ratio, k, d, 3.0) for d in range(n_person)] for k in range(n_track)
    ]
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12)


def test_ratios_beyond_any_number_share_without_overflow():
    ratio = np.array([[1e6], [1e6], [-np.inf]])
    shares = [kernels.responsibility(ratio, k, 0, 3.0) for k in range(3)]
    assert shares == pytest.approx([0.5, 0.5, 0.0])


@given(SEEDS)
def test_a_frame_set_is_associated_image_by_image(seed):
    rng = np.random.default_rng(seed)
    xyz, cov = map(np.stack, zip(*[somebody(rng) for _ in range(3)], strict=True))
    cam, offset = np.array([2, 0]), np.array([0, 2, 2])
    xy, factor = map(
        np.stack, zip(*[seen(rng, MODEL.cameras.P[2], x) for x in (xyz[1], xyz[0])], strict=True)
    )
    match, flip = np.empty((3, 2), np.int64), np.empty((3, 2), np.int64)
    sure = np.empty((3, 2))
    kernels.associate_all(
        MODEL.cameras, MODEL.noise, kernels.Measurements(cam, offset, xy, factor),
        kernels.Prediction(np.zeros(2), 0.0, np.stack([xyz, xyz]), cov, np.ones((2, 3))), np.inf,
        kernels.Matches(match, flip, sure),
    )  # fmt: skip
    ratio, mirrored = score(2, xyz, cov, xy, factor)
    best = np.empty(3, np.int64)
    kernels.match_view(ratio, best)
    np.testing.assert_array_equal(match[:, 0], best)
    assert (match[:, 1] == -1).all()
    share = reference.responsibility(ratio, 3.0)
    for k in np.flatnonzero(best >= 0):
        assert flip[k, 0] == mirrored[k, best[k]]
        assert sure[k, 0] == pytest.approx(share[k, best[k]])
    assert (sure[best < 0, 0] == 0).all()


def test_detections_are_free_taken_or_of_a_track_that_one_camera_alone_supports():
    match = np.array([[0, -1, 5], [1, 3, -1], [-1, -1, -1]])
    owner = np.empty(6, np.int64)
    open_ = kernels.owners(match, np.array([9.9, 8.0, 7.0]), 10.0, 0.12, owner)
    free, taken = kernels.FREE, kernels.TAKEN
    assert owner.tolist() == [taken, 1, free, 1, free, taken]
    assert open_ == 4


@given(SEEDS)
def test_detections_of_further_cameras_join_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    xyz, _ = somebody(rng)
    xyz[rng.random(17) < 0.2] = np.nan
    cam, t_s, taken_s = rng.integers(4, size=8), rng.uniform(1.0, 1.1, 8), 1.05
    off_m = rng.choice([0.03, 0.06, 3.0], 8)
    drawn = [seen(rng, MODEL.cameras.P[c], xyz + off) for c, off in zip(cam, off_m, strict=True)]
    xy, factor = map(np.stack, zip(*drawn, strict=True))
    free, joined, flip = rng.random(8) < 0.8, np.array([7, -1, -1, -1]), np.zeros(4, np.int64)
    kernels.join_all(
        MODEL.cameras, MODEL.noise, (cam, t_s, xy, factor), xyz, taken_s, free, joined, flip
    )
    assert joined[0] == 7
    for c in range(1, 4):
        here = np.flatnonzero((cam == c) & free)
        if not len(here):
            assert joined[c] == -1
            continue
        cov = np.tile(np.eye(3) * (0.08**2 + (t_s[here[0]] - taken_s) ** 2), (17, 1, 1))
        ratio = np.array([
            [
                reference.score_pair(
                    MODEL.cameras.P[c], MODEL.cameras.focal_px[c], xyz, cov, xy[d], factor[d],
                    MODEL.noise, MODEL.cameras.error_px2[c], SETTINGS.outlier_share,
                    SETTINGS.outlier_area_m2, f,
                )
                for f in range(2)
            ]
            for d in here
        ])  # fmt: skip
        best = ratio.max(axis=1).argmax()
        assert joined[c] == (here[best] if ratio[best].max() >= 3.0 else -1)
        assert joined[c] < 0 or flip[c] == ratio[best].argmax()
