"""How far away somebody is whom one camera sees: the kernels equal their slow twins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference_fusion as reference
import reference_ranging as slow
from fusion.somebody import MODEL
from often import often
from trecsim.fusion import kernels
from trecsim.fusion.kernels.body_size import ankle_drop, upright_plane, usual_size_m
from trecsim.fusion.kernels.distance_filter import look, move_on
from trecsim.fusion.kernels.distances import Shown, hold_distances
from trecsim.fusion.kernels.reported_covariance import widen_along_rays
from trecsim.fusion.tuning import (
    KNOWN_RATE_MPS,
    RANGE_DRIFT2_PER_S,
    RANGE_SPEED_MPS,
    SAT_DOWN,
    UPRIGHT,
)
from trecsim.fusion.warmup import _STANDING_M

SEEDS = st.integers(0, 2**32 - 1)
CAMERAS, RULER, TORSO = MODEL.cameras, MODEL.ruler, MODEL.torso
MIRROR = MODEL.noise.mirror
LIVE, KNOT_S, NOW_S = 9, 0.1, 5.13
NOW = kernels.Now(NOW_S, 0.04, 4.5, KNOT_S, 1)
WHEN = ((NOW_S - 4.5) / KNOT_S - 1, KNOT_S)
LOOK_BACK_S = np.full(4, 0.12)


def standing(rng):
    """Draw joints of somebody who stands near the middle of the room, or sits on the ground."""
    xyz = np.array([(x, 0.0, z) for x, z in _STANDING_M]) + rng.normal(0, 0.03, (17, 3))
    xyz[:, 2] *= rng.choice([1.0, 0.6])
    return xyz + np.array([*rng.uniform(-1, 1, 2), 0.0])


def shown_by(rng, cam, xyz_m):
    """Draw key points of a body in one image, a fifth of them missing."""
    xy = np.array([reference.project(CAMERAS.P[cam], x) for x in xyz_m])
    xy[rng.random(17) < 0.2] = np.nan
    return xy + rng.normal(0, 2, (17, 2))


@given(SEEDS, st.floats(0, 1))
def test_what_an_image_tells_of_a_distance_is_what_the_reference_says(seed, missing):
    rng = np.random.default_rng(seed)
    xy = shown_by(rng, 1, standing(rng))
    xy[rng.random(17) < missing] = np.nan
    scale, plane = rng.uniform(1, 6, 17), np.empty((17, 3))
    upright_plane(CAMERAS.ray_of[1], xy, plane)
    with np.errstate(invalid="ignore"):
        expected = slow.at_one_m(CAMERAS.ray_of[1], xy)
    np.testing.assert_allclose(plane, expected, rtol=1e-9, atol=1e-12)
    assert usual_size_m(RULER, plane) == pytest.approx(
        slow.usual_size_m(RULER, expected), rel=1e-9, nan_ok=True
    )
    assert ankle_drop(RULER, plane, scale) == pytest.approx(
        slow.ankle_drop(RULER, expected, scale), rel=1e-9, nan_ok=True
    )


@given(SEEDS, st.floats(0, 0.5), st.sampled_from([0.04, 0.3, np.inf]))
def test_the_filter_of_a_distance_equals_kalmans(seed, elapsed_s, since_s):
    rng = np.random.default_rng(seed)
    mean, cov = slow.begun(np.log(rng.uniform(2, 8)), 0.1)
    size_m, drop = rng.uniform(2, 8), (rng.uniform(0.2, 1), rng.uniform(1, 3), rng.integers(1, 3))
    expected, expected_cov, agrees = slow.looked(
        *slow.moved_on(mean, cov, elapsed_s), size_m, drop, 2.5, since_s
    )
    move_on(mean, cov, elapsed_s)
    assert look(mean, cov, size_m, (*drop[:2], int(drop[2])), 2.5, since_s) == agrees
    np.testing.assert_allclose(mean, expected, rtol=1e-9)
    np.testing.assert_allclose(cov, expected_cov, rtol=1e-9, atol=1e-12)


@given(SEEDS)
def test_the_first_distances_of_newcomers_equal_the_reference(seed):
    rng = np.random.default_rng(seed)
    cam, level = rng.integers(4, size=5), (0.1, 0.04)
    xy = np.array([shown_by(rng, c, standing(rng)) for c in cam])
    xy[0] = np.nan
    scale = rng.uniform(1, 3, (5, 17))
    ranges = ranges_of(5)
    agrees, plane = np.empty(5, bool), np.empty((5, 17, 3))
    kernels.first_distances(CAMERAS, RULER, cam, (xy, scale), level, ranges, agrees, plane)
    assert not agrees[0]
    assert ranges.cam.tolist() == cam.tolist()
    for d in range(1, 5):
        there = slow.at_one_m(CAMERAS.ray_of[cam[d]], xy[d])
        size_m = slow.usual_size_m(RULER, there)
        above_m = CAMERAS.position_m[cam[d], 2] - RULER.ankle_height_m - level[0]
        first = slow.begun(np.log(size_m), np.sqrt(level[1]) / above_m)
        drop = slow.ankle_drop(RULER, there, scale[d])
        mean, cov, agreed = slow.looked(*first, size_m, drop, above_m, np.inf)
        np.testing.assert_allclose(ranges.mean[d], mean, rtol=1e-9)
        np.testing.assert_allclose(ranges.cov[d], cov, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(plane[d], there, rtol=1e-9)
        assert agrees[d] == (agreed and np.isfinite(size_m))


def ranges_of(n):
    return kernels.Ranges(np.full(n, -1), np.zeros((n, 4)), np.zeros((n, 4, 4)), np.zeros(n, bool))


class Scene:
    """Some tracks, three images that show them, and filters of some distances."""

    def __init__(self, rng, n=4):
        xyz = np.array([standing(rng) for _ in range(n)])
        R = np.triu(rng.normal(size=(n, 17, 3 * LIVE, 3 * LIVE)))
        for i in range(3 * LIVE):
            R[..., i, (i // 3) * 3 + 12 :] = 0.0
        c = np.tile(xyz, LIVE) + rng.normal(0, 0.02, (n, 17, 3 * LIVE))
        x = np.array([slow.joints_at(one, WHEN[0]) for one in c])
        A = rng.normal(0, 0.1, (n, 17, 3, 3))
        self.tracks = kernels.Trajectories(
            R, np.einsum("kjab,kjb->kja", R, c), c, x, A @ A.swapaxes(2, 3)
        )
        n_limb = len(MODEL.body.length_m)
        self.bodies = kernels.Bodies(
            MODEL.body.length_m * rng.uniform(0.9, 1.1, (n, 1)), np.full((n, n_limb), 1e-4),
            np.c_[rng.normal(0, 0.1, n), np.full(n, 0.01)],
        )  # fmt: skip
        self.camera_s = NOW_S - rng.choice([0.0, 0.05, 9.0, 9.0, 9.0], (n, 4))
        self.joint_s = NOW_S - rng.choice([0.0, 0.0, 9.0], (n, 17, 4))
        self.confirmed = rng.random(n) < 0.8
        self.ranges = ranges_of(n)
        self.ranges.cam[:] = rng.integers(-1, 4, n)
        for k in range(n):
            spread = np.linalg.norm(x[k, TORSO].mean(axis=0)[:2] - [3, 2.5]) * 0.01
            self.ranges.mean[k], self.ranges.cov[k] = slow.begun(np.log(4.0 + spread), 0.1)
            self.ranges.cov[k] *= 0.05
        self.ranges.is_upright[:] = rng.random(n) < 0.5
        cam = np.array([2, 0, 1])
        xy = np.array([shown_by(rng, c, one) for c in cam for one in xyz])
        self.measured = kernels.Measurements(
            cam, n * np.arange(4), xy, rng.uniform(1, 3, xy.shape[:2])
        )
        match = np.arange(n)[:, None] + n * np.arange(3)
        match[rng.random((n, 3)) < 0.4] = -1
        self.matches = kernels.Matches(match, rng.integers(2, size=(n, 3)), np.ones((n, 3)))
        self.taken = kernels.Taken(
            NOW_S - np.array([0.0, 0.01, 0.0]), np.array([0.04, 0.08, np.inf]), LOOK_BACK_S,
            np.zeros(3), np.zeros(3, bool),
        )  # fmt: skip

    def held(self, is_single):
        """Run the kernel in place."""
        n = len(self.confirmed)
        nothing, off = np.zeros(n), np.zeros(self.joint_s.shape)
        sightings = kernels.Sightings(
            self.camera_s, self.joint_s, nothing, nothing, nothing, off, off, np.zeros((n, 4, 2))
        )
        shown = Shown(CAMERAS, MIRROR, TORSO, RULER, self.measured, self.taken)
        hold_distances(
            shown, self.tracks, self.bodies, sightings, self.confirmed, self.ranges, self.matches,
            NOW, is_single,
        )  # fmt: skip

    def filter_of(self, k):
        return self.ranges.mean[k].copy(), self.ranges.cov[k].copy()

    def person(self, k):
        return self.tracks.c[k].copy(), self.tracks.x_m[k].copy(), self.tracks.cov_m2[k]

    def shown(self, k, cam):
        """Yield images of a camera, the detections of track `k` there, and its joints at 1 m."""
        for v, d in enumerate(self.matches.match[k]):
            if d < 0 or self.measured.cam[v] != cam:
                continue
            good = self.joint_s[k, :, cam] >= self.taken.t_s[v] - 1e-6
            good = good[MIRROR] if self.matches.flip[k, v] else good
            xy = np.where(good[:, None], self.measured.xy_px[d], np.nan)
            with np.errstate(invalid="ignore"):
                yield v, d, slow.at_one_m(CAMERAS.ray_of[cam], xy)

    def looked(self, k, cam, found):
        """Take in what the images of its camera tell of track `k`."""
        above_m = CAMERAS.position_m[cam, 2] - RULER.ankle_height_m - self.bodies.level[k, 0]
        for v, d, there in self.shown(k, cam):
            drop = slow.ankle_drop(RULER, there, self.measured.sigma_scale[d])
            size_m = slow.usual_size_m(RULER, there)
            *found, _ = slow.looked(*found, size_m, drop, above_m, self.taken.since_s[v])
        return found

    def put(self, k, cam, found):
        """Return the control points at the distance of a filter."""
        origin_m = CAMERAS.position_m[cam]
        log_m, rate = found[0][:2]
        return slow.moved_along_rays(self.tracks.c[k], TORSO, origin_m, log_m, rate, *WHEN)


def check(scene, k, cam, found, c):
    """Compare a track after the kernel with what the reference says."""
    assert scene.ranges.cam[k] == cam
    np.testing.assert_allclose(scene.ranges.mean[k], found[0], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(scene.ranges.cov[k], found[1], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(scene.tracks.c[k], c, rtol=1e-7, atol=1e-9)
    z = np.einsum("jab,jb->ja", scene.tracks.R[k], c)
    np.testing.assert_allclose(scene.tracks.z[k], z, rtol=1e-7, atol=1e-7)
    x = slow.joints_at(c, WHEN[0])
    np.testing.assert_allclose(scene.tracks.x_m[k], x, rtol=1e-7, atol=1e-9)


@given(SEEDS)
@settings(max_examples=often(30))
def test_known_people_are_held_at_their_distances_as_by_the_reference(seed):
    scene = Scene(np.random.default_rng(seed))
    expected = []
    for k in range(len(scene.confirmed)):
        seeing = np.flatnonzero(scene.camera_s[k] > NOW_S - 0.12)
        found, cam, c = scene.filter_of(k), int(scene.ranges.cam[k]), scene.tracks.c[k].copy()
        if not scene.confirmed[k] or len(seeing) > 1:
            expected.append((k, -1, found, c, None))
            continue
        if cam >= 0:
            found = slow.moved_on(*found, NOW.elapsed_s)
        up = bool(scene.ranges.is_upright[k])
        if len(seeing) == 1:
            if cam != seeing[0]:
                before_m2, cam, up = found[1][0, 0] if cam >= 0 else 0.0, int(seeing[0]), False
                body = [values[k] for values in scene.bodies]
                person = scene.person(k)
                found = slow.known(CAMERAS, RULER, cam, TORSO, person, body, WHEN, before_m2)
            for _, _, there in scene.shown(k, cam):
                share = np.exp(found[0][0]) * slow.height_share(
                    there, scene.bodies.limb_m[k], RULER
                )
                up = up if np.isnan(share) else bool(share >= (SAT_DOWN if up else UPRIGHT))
            if up:
                found = scene.looked(k, cam, found)
                c = scene.put(k, cam, found)
            else:
                log_m, rate = slow.log_range(c, TORSO, CAMERAS.position_m[cam], *WHEN)
                variance = found[1][0, 0] + RANGE_DRIFT2_PER_S * NOW.elapsed_s
                found = slow.anew(*found, log_m, rate, variance, KNOWN_RATE_MPS)
        expected.append((k, cam, found, c, up))
    scene.held(is_single=False)
    for k, cam, found, c, up in expected:
        check(scene, k, cam, found, c)
        assert up is None or scene.ranges.is_upright[k] == up


@given(SEEDS)
@settings(max_examples=often(30))
def test_people_of_one_camera_are_held_at_their_distances_as_by_the_reference(seed):
    scene = Scene(np.random.default_rng(seed))
    scene.ranges.cam[:] = np.maximum(scene.ranges.cam, 0)
    expected = []
    for k in range(len(scene.confirmed)):
        found = slow.moved_on(*scene.filter_of(k), NOW.elapsed_s)
        cam = int(scene.ranges.cam[k])
        found = scene.looked(k, cam, found)
        seen_by = {int(c) for c in scene.measured.cam[scene.matches.match[k] >= 0]}
        if seen_by and (cam not in seen_by or len(seen_by) > 1):
            cam = cam if cam in seen_by else min(seen_by)
            c, x, cov_m2 = scene.person(k)
            origin_m = CAMERAS.position_m[cam]
            variance = slow.relative_variance(x, cov_m2, TORSO, origin_m)
            log_m, rate = slow.log_range(c, TORSO, origin_m, *WHEN)
            found = slow.anew(*found, log_m, rate, variance, RANGE_SPEED_MPS)
        expected.append((k, cam, found, scene.put(k, cam, found)))
    scene.held(is_single=True)
    for one in expected:
        check(scene, *one)


@given(SEEDS)
def test_covariances_grow_along_the_rays_by_the_share_that_distances_are_off(seed):
    rng = np.random.default_rng(seed)
    x, origin_m = rng.normal(size=(17, 3)), rng.normal(size=3)
    cov, speed_cov = rng.normal(size=(2, 17, 3, 3))
    expected, expected_speed = cov.copy(), speed_cov.copy()
    for j in range(17):
        along = np.outer(x[j] - origin_m, x[j] - origin_m)
        expected[j] += 0.3**2 * along
        expected_speed[j] += 0.2**2 * along
    widen_along_rays(origin_m, np.diag([0.3**2, 0.2**2, 9.0, 9.0]), x, cov, speed_cov)
    np.testing.assert_allclose(cov, expected, atol=1e-12)
    np.testing.assert_allclose(speed_cov, expected_speed, atol=1e-12)
