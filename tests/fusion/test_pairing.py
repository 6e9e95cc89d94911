"""Rays of two cameras meet where least squares says; wrong pairs of detections are found out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.made import made, path
from fusion.somebody import MODEL
from often import often
from trecsim.fusion import kernels
from trecsim.lab.simulation.detector_errors import PERFECT

CAMERAS = MODEL.cameras
SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_rays_meet_where_least_squares_says(seed):
    rng = np.random.default_rng(seed)
    target = rng.normal(size=3)
    p, q = target + rng.normal(size=3) * 4, target + rng.normal(size=3) * 4
    u = (target - p) / np.linalg.norm(target - p)
    v = target + rng.normal(0, 0.05, 3) - q
    v /= np.linalg.norm(v)
    point = np.empty(3)
    gap = kernels.ray_midpoint(p, u, q, v, point)
    if np.isnan(gap):
        return
    middle, distance = reference.midpoint(p, u, q, v)
    np.testing.assert_allclose(point, middle, atol=1e-7)
    assert gap == pytest.approx(distance, abs=1e-7)


def test_rays_that_meet_behind_a_camera_do_not_meet():
    ahead, origin = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    beside = np.array([1.0, 0.0, 0.0])
    away = np.array([0.6, 0.0, 0.8])
    assert np.isnan(kernels.ray_midpoint(origin, ahead, beside, away, np.empty(3)))


def drawn(rng):
    """Draw two images of three people, tracks that hold some of the detections, and factors."""
    standing = made([path((0, 0, 0), (1, 0, 0))], detector=PERFECT, seconds=1.0).truth_xyz_m[0, 0]
    people = standing + np.c_[rng.uniform(-1, 1, (3, 2)), np.zeros(3)][:, None]
    eyes = MODEL.rig.cameras[:2]
    xy_px = np.concatenate([camera.project(people) for camera in eyes])
    xy_px += rng.normal(0, 8, xy_px.shape)
    xy_px[rng.random(xy_px.shape[:2]) < 0.2] = np.nan
    match = np.stack([rng.permutation(3), 3 + rng.permutation(3)], axis=1)
    match[rng.random((3, 2)) < 0.2] = -1
    return eyes, xy_px, rng.uniform(1, 4, xy_px.shape[:2]), match


def two_images(xy_px, factor):
    """Return the detections of two images, three in each."""
    return kernels.Measurements(np.array([0, 1]), np.array([0, 3, 6]), xy_px, factor)


@settings(max_examples=often(10))
@given(SEEDS)
def test_pairs_of_detections_are_scored_as_by_the_reference(seed):
    eyes, xy_px, factor, _ = drawn(np.random.default_rng(seed))
    cam = np.repeat([0, 1], 3)
    direction = np.array(
        [[reference.ray(eyes[c], xy) for xy in xy_px[d]] for d, c in enumerate(cam)]
    )
    rays = kernels.Rays(cam, CAMERAS.position_m[cam], direction, factor, np.zeros(6))
    score, flip = np.full((6, 6), np.nan), np.full((6, 6), -1)
    kernels.pair_scores(rays, MODEL.bones, MODEL.noise, score, flip)
    for i in range(6):
        for k in range(i + 1, 6):
            readings = [-np.inf, -np.inf]
            if cam[i] != cam[k]:
                readings = reference.pair_readings(
                    eyes, xy_px[[i, k]], factor[[i, k]], *MODEL.bones, MODEL.noise
                )
            assert score[i, k] == pytest.approx(max(readings), abs=1e-6)
            assert flip[i, k] == np.argmax(readings)
    assert np.isfinite(score[:3, 3:]).any()


@settings(max_examples=often(10))
@given(SEEDS)
def test_evidence_for_other_pairs_grows_as_the_twin_says(seed):
    rng = np.random.default_rng(seed)
    eyes, xy_px, factor, match = drawn(rng)
    before = rng.uniform(0, 30, 3)
    evidence = before.copy()
    kernels.note_swaps(
        MODEL.cameras, MODEL.bones, MODEL.noise, two_images(xy_px, factor), match, evidence
    )

    def score(i, k):
        return reference.pair_score(eyes, xy_px[[i, k]], factor[[i, k]], *MODEL.bones, MODEL.noise)

    gains = reference.exchange_gains(match, np.array([0, 0, 0, 1, 1, 1]), score, 25.0)
    expected = np.maximum(before + np.clip(gains, -20, 20), 0)
    np.testing.assert_allclose(evidence, expected, atol=1e-6)


def test_two_people_made_of_the_wrong_halves_are_found_out():
    """Each is seen by one camera only at first, so that one body is made of both of them."""
    rng = np.random.default_rng(0)
    _, xy_px, factor, _ = drawn(rng)
    evidence = np.zeros(3)
    for match, crossed in (([0, 4], True), ([0, 3], False)):
        evidence[:] = 0.0
        rows = np.array([match, [match[0] + 1, 7 - match[1]], [-1, -1]])
        for _ in range(3):
            kernels.note_swaps(
                MODEL.cameras, MODEL.bones, MODEL.noise, two_images(xy_px, factor), rows, evidence
            )
        assert (evidence[:2] > 20).all() == crossed
        assert evidence[2] == 0


@settings(max_examples=often(20))
@given(SEEDS)
def test_who_is_needless_is_as_the_twin_says(seed):
    rng = np.random.default_rng(seed)
    *_, match = drawn(rng)
    standing = made([path((0, 0, 0), (1, 0, 0))], detector=PERFECT, seconds=1.0).truth_xyz_m[0, 0]
    people = standing + np.c_[rng.uniform(-0.1, 0.1, (3, 2)), np.zeros(3)][:, None]
    xy_px = np.concatenate([eye.project(people) for eye in MODEL.rig.cameras[:2]])
    xy_px += rng.normal(0, rng.choice([3, 15]), (6, 1, 2))
    xyz_m = np.stack([people, people])
    confirmed, looks = rng.random(3) < 0.8, np.array([0.0, 1.0, 2.0])
    before = looks.copy()
    kernels.note_redundant(
        MODEL.cameras, two_images(xy_px, np.ones((6, 17))), xyz_m, match, confirmed, looks
    )
    needless = reference.needless(CAMERAS.P, CAMERAS.focal_px, xyz_m, xy_px, match, confirmed)
    np.testing.assert_array_equal(looks, np.where(needless, before + 1, np.maximum(before - 1, 0)))


def test_a_body_made_of_two_others_who_fit_its_detections_is_needless():
    people = np.array([[-0.5, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.4, 1.0]])[:, None]
    people = np.ascontiguousarray(np.broadcast_to(people, (3, 17, 3)))
    xy_px = np.concatenate([eye.project(people) for eye in MODEL.rig.cameras[:2]])
    looks = np.zeros(3)
    # The third is seen where the first should be in one image, and the second in the other.
    match = np.array([[-1, 3], [1, -1], [0, 4]])
    for confirmed, expected in (([True] * 3, [0, 0, 1]), ([True, False, True], [0, 0, 0])):
        kernels.note_redundant(
            MODEL.cameras, two_images(xy_px, np.ones((6, 17))), np.stack([people, people]), match,
            np.array(confirmed), looks,
        )  # fmt: skip
        assert looks.tolist() == expected


def test_a_track_that_one_image_shows_clearly_better_than_others_is_needed():
    people = np.array([[-0.5, 0.0, 1.0], [0.5, 0.0, 1.0], [-0.43, 0.0, 1.0]])[:, None]
    people = np.ascontiguousarray(np.broadcast_to(people, (3, 17, 3)))
    first, second = (eye.project(people) for eye in MODEL.rig.cameras[:2])
    # The third stands 7 cm beside the first, whom neither image shows.
    match, looks = np.array([[-1, -1], [1, 4], [2, 5]]), np.array([0.0, 0.0, 1.0])
    for shown, expected in ((people[2], 0.0), (people[0], 1.0)):
        first[2], second[2] = (eye.project(shown) for eye in MODEL.rig.cameras[:2])
        kernels.note_redundant(
            MODEL.cameras, two_images(np.concatenate([first, second]), np.ones((6, 17))),
            np.stack([people, people]), match, np.ones(3, bool), looks,
        )  # fmt: skip
        assert looks[2] == expected


@given(SEEDS)
def test_midpoints_of_detections_are_those_of_their_rays(seed):
    rng = np.random.default_rng(seed)
    target = rng.normal(size=(17, 3))
    p, q = rng.normal(0, 4, 3), rng.normal(0, 4, 3)
    u, v = target - p, target + rng.normal(0, 0.2, (17, 3)) - q
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    u[rng.random(17) < 0.2] = np.nan
    found, expected = np.empty((17, 3)), np.full((17, 3), np.nan)
    for j in range(17):
        point = np.empty(3)
        if kernels.ray_midpoint(p, u[j], q, v[j], point) < 0.25:
            expected[j] = point
    count = kernels.midpoints(p, u, q, v, 0.25, found)
    np.testing.assert_array_equal(found, expected)
    assert count == np.isfinite(expected[:, 0]).sum()
