"""Limb lengths: learnt where two cameras look, used where they do not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

import reference_fusion as reference
from fusion.made import frame_sets, made, outcome, path, truth_at
from fusion.somebody import MODEL, limbs_of
from trecsim.fusion import FusionSettings, Tracker, kernels, tuning
from trecsim.fusion.body import stiffness, usual_body
from trecsim.fusion.kernels import anatomy, body_equations, cholesky, lengths
from trecsim.fusion.limb_directions import postures
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.skeleton import COCO17, Skeleton
from trecsim.values import FrameSet, Poses2D

KNOTS = 3.4
NO_POSTURES = postures(Skeleton("arm", ("a", "b", "c"), ((0, 1), (1, 2)), (0, 1, 2)))


def body_of(limb_m, limb_m2):
    """Return what is known of one body, on a ground of known height."""
    return kernels.Bodies(limb_m, limb_m2, np.array([0.0, 1.0]))


def joint_of(R, z, c, x, cov_m2):
    return kernels.Trajectories(R, z, c, x, cov_m2)


def moment_of(span, weights, white_share=1.0, new_share=0.0):
    return anatomy.Moment(span, weights, white_share, new_share)


ACROSS = path((0, -2, 0), (6, 2, 0))


def only(frame_set, cameras):
    return FrameSet(frame_set.t_s, tuple(v for v in frame_set.views if v.camera in cameras))


def blind_to(view, joints):
    xy = view.xy_px.copy()
    xy[:, joints] = np.nan
    return Poses2D(view.camera, view.t_s, xy, view.score, view.person_score)


def test_every_bone_of_the_trunk_and_limbs_has_a_usual_length():
    body = usual_body(COCO17)
    bones = {tuple(pair) for pair in body.joints[body.bone]}
    limbs = {tuple(sorted(limb)) for limb in COCO17.limbs}
    assert bones == limbs
    assert (body.length_m > 0.03).all()
    assert (body.length_m < 0.7).all()


def test_lengths_that_two_cameras_have_taught_hold_a_body_before_one():
    """Somebody of unusual size is followed with the own lengths, not with the usual ones."""
    scene = made([ACROSS], detector=PERFECT, cameras=2)
    tracker = Tracker(scene.rig, FusionSettings(single_view_death_s=60.0))
    one = {scene.rig.names[0]}
    last = [tracker.step(only(s, one) if s.t_s > 4.0 else s) for s in frame_sets(scene)][-1]
    body = usual_body(COCO17)
    first, second = body.joints[body.slack_m <= 0.01].T
    truth = scene.truth_xyz_m[0, 100]
    true_m = np.linalg.norm(truth[first] - truth[second], axis=1)
    found_m = np.linalg.norm(last.xyz_m[0, first] - last.xyz_m[0, second], axis=1)
    usual_m = body.length_m[body.slack_m <= 0.01]
    assert np.abs(usual_m - true_m).max() > 0.02
    assert np.abs(found_m - true_m).max() < 0.5 * np.abs(usual_m - true_m).max()


def test_a_joint_that_one_camera_sees_keeps_its_distance_from_the_body():
    head = [0, 1, 2, 3, 4]
    scene = made([ACROSS], detector=PERFECT)
    first = scene.rig.names[0]
    sets = [
        FrameSet(s.t_s, tuple(v if v.camera == first else blind_to(v, head) for v in s.views))
        for s in frame_sets(scene)
    ]
    tracker = Tracker(scene.rig)
    snapshots = [tracker.step(s) for s in sets]
    truth = scene.truth_xyz_m[0, -1]
    last = snapshots[-1]
    assert (last.support[0, head] <= 1).all()
    assert np.linalg.norm(last.xyz_m[0, head] - truth[head], axis=1).max() < 0.15


def test_somebody_whom_only_one_camera_sees_keeps_the_right_distance():
    scene = made([ACROSS], detector=PERFECT)
    eye = scene.rig.names[0]
    sets = [s if s.t_s < 2 else only(s, {eye}) for s in frame_sets(scene)]
    tracker = Tracker(scene.rig, FusionSettings(single_view_death_s=60.0))
    result = outcome(scene, [tracker.step(s) for s in sets if s.views and s.t_s < 4])
    assert result.ids == {0}
    assert not np.isnan(result.error_m).any()
    assert result.error_m[50:].max() < 0.35


def test_weak_joints_land_where_least_squares_puts_them():
    """Covariances along rays, limb lengths, one solid joint: the kernel equals SciPy's minimum."""
    rng = np.random.default_rng(7)
    x = rng.normal(0, 0.4, (4, 3))
    A = rng.normal(0, 0.1, (4, 3, 3))
    cov = A @ A.swapaxes(1, 2) + 1e-3 * np.eye(3)
    known = np.linalg.inv(cov)
    pairs = np.array([[0, 1], [1, 2], [2, 3], [0, 3]])
    length = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) * [1.1, 0.9, 1.05, 1.0]
    var = np.full(4, 0.02**2)
    place = np.array([-1, 0, 3, 6])
    A, b = np.empty((9, 9)), np.empty(9)
    d = np.zeros((4, 3))
    limbs = limbs_of(pairs, 0.01**2)
    for _ in range(60):
        shifts = body_equations.Shifts(x, d, cov, known, place)
        body_equations.gather(A, b, shifts, limbs, body_of(length, var))
        cholesky.cholesky(A)
        cholesky.solve_cholesky(A, b)
        d[1:] = b.reshape(3, 3)

    def residuals(shift, d=d):
        moved = x + np.vstack([np.zeros(3), shift.reshape(3, 3)])
        parts = [np.linalg.cholesky(np.linalg.inv(cov[j])).T @ (moved - x)[j] for j in (1, 2, 3)]
        parts.append(shift / np.sqrt(tuning.REACH_M2))
        for (j, k), m in zip(pairs, length, strict=True):
            u = moved[k] - moved[j]
            fixed = (x + d)[k] - (x + d)[j]
            fixed /= np.linalg.norm(fixed)
            noise = 0.02**2 + 0.01**2 + 0.01**2 + (fixed @ cov[0] @ fixed if 0 in (j, k) else 0.0)
            parts.append([(np.linalg.norm(u) - m) / np.sqrt(noise)])
        return np.concatenate(parts)

    expected = least_squares(residuals, np.zeros(9), xtol=1e-14, ftol=1e-14).x
    np.testing.assert_allclose(d[1:].ravel(), expected, atol=2e-5)


def test_a_factor_gives_solutions_and_the_blocks_of_the_inverse():
    rng = np.random.default_rng(11)
    A = rng.normal(size=(9, 9))
    A = A @ A.T + np.eye(9)
    b = rng.normal(size=9)
    expected, inverse = np.linalg.solve(A, b), np.linalg.inv(A)
    cholesky.cholesky(A)
    cholesky.solve_cholesky(A, b)
    np.testing.assert_allclose(b, expected, atol=1e-10)
    cholesky.invert_cholesky(A)
    block = np.empty((3, 3))
    for first in (0, 3, 6):
        cholesky.joint_block(A, first, block)
        np.testing.assert_allclose(block, inverse[first : first + 3, first : first + 3], atol=1e-10)


def test_a_trajectory_follows_a_moved_joint_as_the_conditional_mean_does():
    rng = np.random.default_rng(8)
    R, c, weights = reference.banded(rng), rng.normal(size=24), np.empty(4)
    span = kernels.locate(KNOTS, 8, weights)
    B, shift_m, x = reference.spread_over(span, weights, 24), rng.normal(size=3), np.empty(3)
    cov = np.linalg.inv(R.T @ R)
    expected = c + cov @ B.T @ np.linalg.solve(B @ cov @ B.T, shift_m)
    joint = joint_of(R, np.empty(24), c, x, np.empty((3, 3)))
    anatomy.move_joint(joint, shift_m, moment_of(span, weights), anatomy.workspace(24))
    np.testing.assert_allclose(c, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(x, B @ expected, rtol=1e-9, atol=1e-9)


def test_limbs_pull_joints_to_their_lengths_by_how_sure_each_is():
    """Two joints, one ten times as sure as the other, 10 cm too far apart."""
    x = np.array([[0.0, 0, 0], [0.5, 0, 0]])
    cov = np.stack([np.eye(3) * 1e-4, np.eye(3) * 1e-2])
    limbs = limbs_of([[0, 1]])
    lengths.tighten(x, cov, limbs, body_of(np.array([0.4]), np.zeros(1)))
    first = 1e-4 + 1e-2 + tuning.TIE_M2
    after = cov[:, 0, 0].sum()  # the covariances shrink in the first of four sweeps only
    moved = 0.1 - 0.1 * (1 - (1e-4 + 1e-2) / first) * (1 - after / (after + tuning.TIE_M2)) ** 3
    assert np.isclose(0.5 - (x[1, 0] - x[0, 0]), moved)
    assert x[0, 0] < 0.01 * moved * 1.5
    assert cov[1, 0, 0] < 1e-3  # along the limb
    assert cov[1, 1, 1] == 1e-2  # across


def test_a_joint_goes_where_its_body_says_and_gets_no_surer_for_it():
    """Where nothing is new in the message: the place follows, the information does not grow."""
    R, z, c = np.zeros((1, 24, 24)), np.zeros((1, 24)), np.zeros((1, 24))
    kernels.start_all(R, z, c, np.ones((1, 3)), np.array([0.3]), 0.05, np.array([20.0]), 0)
    weights = np.empty(4)
    span = kernels.locate(3.4, 8, weights)
    before, x, known = R.copy(), np.ones(3), np.eye(3) / 0.3**2
    cov_m2 = np.linalg.inv(known + np.eye(3) / 0.05**2 + np.eye(3) / tuning.REACH_M2)
    there = np.array([1.3, 0.9, 1.1])
    anatomy.apply_body(
        joint_of(R[0], z[0], c[0], x, cov_m2), known, there - x, moment_of(span, weights),
        anatomy.workspace(24),
    )  # fmt: skip
    np.testing.assert_allclose(x, there, atol=1e-9)
    np.testing.assert_array_equal(R, before)
    np.testing.assert_allclose(R[0] @ c[0], z[0], atol=1e-9)
    # The bound on a step does not count as knowledge.
    np.testing.assert_allclose(cov_m2, np.linalg.inv(known + np.eye(3) / 0.05**2), rtol=1e-9)


def test_what_is_new_of_a_body_is_information_about_its_joint():
    rng = np.random.default_rng(5)
    R, c, z, weights = reference.banded(rng), rng.normal(size=24), np.empty(24), np.empty(4)
    span = kernels.locate(3.4, 8, weights)
    B, x = reference.spread_over(span, weights, 24), np.zeros(3)
    known, said = np.eye(3), np.diag([900.0, 30.0, 2.0])
    held_m2 = np.linalg.inv(known + said + np.eye(3) / tuning.REACH_M2)
    expected = R.T @ R + 0.2 / 0.5 * B.T @ said @ B
    anatomy.apply_body(
        joint_of(R, z, c, x, held_m2), known, np.zeros(3), moment_of(span, weights, 0.5, 0.2),
        anatomy.workspace(24),
    )  # fmt: skip
    np.testing.assert_allclose(R.T @ R, expected, atol=1e-9)
    np.testing.assert_allclose(R @ c, z, atol=1e-9)


def people_after_a_fit(rng, n=2):
    """Draw people of usual size, joints of all degrees of certainty, and what is known of them."""
    standing = made([path((0, 0, 0), (1, 0, 0))], detector=PERFECT, seconds=1.0).truth_xyz_m[0, 0]
    weights = np.empty(4)
    span = kernels.locate(KNOTS, 8, weights)
    R, c = np.empty((n, 17, 24, 24)), np.empty((n, 17, 24))
    cov_m2, x = np.empty((n, 17, 3, 3)), np.empty((n, 17, 3))
    for k in range(n):
        for j in range(17):
            R[k, j] = rng.choice([3.0, 30.0, 100.0]) * reference.banded(rng)
            c[k, j] = np.tile(standing[j] + rng.normal(0, 0.03, 3), 8) + rng.normal(0, 0.005, 24)
    kernels.evaluate_all(c, np.array([KNOTS]), x[None])
    kernels.covariance_all(R, KNOTS, cov_m2)
    z = np.einsum("kjab,kjb->kja", R, c)
    limb_m = np.tile(MODEL.body.length_m, (n, 1)) * rng.uniform(0.8, 1.2, (n, 24))
    bodies = kernels.Bodies(
        limb_m, rng.uniform(0.005, 0.05, (n, 24)) ** 2,
        np.stack([rng.normal(0, 0.05, n), rng.uniform(0.02, 0.3, n) ** 2], axis=1),
    )  # fmt: skip
    place = reference.spread_over(span, weights, 24)
    unseen_s = np.where(rng.random((n, 17)) < 0.5, 0.0, rng.uniform(0.1, 0.6, (n, 17)))
    sights = rng.integers(0, 4, (n, 17)), unseen_s
    return kernels.Trajectories(R, z, c, x, cov_m2), bodies, sights, place


def part_of(group, k):
    """Return a copy of the part of one track."""
    return type(group)(*(values[k].copy() for values in group))


def assert_is_relaxed(person, expected, new_share):
    information, c, x, cov_m2 = expected
    np.testing.assert_allclose(person.x_m, x, atol=1e-6)
    np.testing.assert_allclose(person.c, c, atol=1e-6)
    scale = np.abs(cov_m2).max(axis=(1, 2))[:, None, None]
    np.testing.assert_allclose(person.cov_m2 / scale, cov_m2 / scale, atol=1e-6)
    # A direction of which the body says less than a millionth of what is known of the joint is no
    # row of its own, so that mixed elements may miss a thousandth.
    known = np.trace(np.linalg.inv(cov_m2), axis1=1, axis2=2) + 3 / tuning.REACH_M2
    missed = 1e-3 * new_share / np.sqrt(0.3) * known + 1e-9 * np.abs(information).max()
    off = np.abs(person.R.swapaxes(1, 2) @ person.R - information).max(axis=(1, 2))
    np.testing.assert_array_less(off, missed)
    right = np.einsum("jab,jb->ja", person.R, person.c)
    np.testing.assert_allclose(right, person.z, atol=1e-9 * np.abs(right).max())


@pytest.mark.parametrize("seed", range(12))
def test_a_body_is_held_together_as_by_the_reference(seed):
    tracks, bodies, (n_seen, unseen_s), place = people_after_a_fit(np.random.default_rng(seed), 1)
    person, body, sights = part_of(tracks, 0), part_of(bodies, 0), (n_seen[0], unseen_s[0])
    expected = reference.relaxed(
        person, body, sights, MODEL.limbs, MODEL.postures, place, 0.3, 0.05
    )
    weights = np.empty(4)
    moment = moment_of(kernels.locate(KNOTS, 8, weights), weights, 0.3, 0.05)
    anatomy.relax_body(
        person, body, sights, MODEL.limbs, MODEL.postures, moment, anatomy.workspace(24)
    )
    assert_is_relaxed(person, expected, 0.05)
    assert (np.abs(person.x_m - tracks.x_m[0]).max(axis=1) > 1e-4).sum() >= 4


@pytest.mark.parametrize("seed", range(6))
def test_lengths_ground_and_joints_of_all_people_change_as_by_the_reference(seed):
    elapsed_s = 0.04
    tracks, bodies, sights, place = people_after_a_fit(np.random.default_rng(seed))
    (n_seen, unseen_s), learnt, expected = sights, [], []
    for k in range(2):
        person, body = part_of(tracks, k), part_of(bodies, k)
        for i, (a, b) in enumerate(MODEL.limbs.joints):
            if min(n_seen[k, a], n_seen[k, b]) < 2:
                continue
            u = person.x_m[b] - person.x_m[a]
            length = np.linalg.norm(u)
            var = u @ (person.cov_m2[a] + person.cov_m2[b]) @ u / length**2
            var += 0.02**2 + MODEL.limbs.slack_m2[i]
            body.limb_m[i], body.limb_m2[i] = reference.learnt(
                body.limb_m[i], body.limb_m2[i], length, var, elapsed_s / 0.5
            )
        body.level[:] = reference.levelled(
            body.level, person.x_m, person.cov_m2, n_seen[k], MODEL.limbs.contact_height_m,
            elapsed_s,
        )  # fmt: skip
        learnt.append(body)
        expected.append(
            reference.relaxed(
                person, body, (n_seen[k], unseen_s[k]), MODEL.limbs, MODEL.postures, place, 0.3,
                elapsed_s / tuning.BODY_S,
            )
        )  # fmt: skip
    kernels.constrain_all(
        tracks, bodies, sights, MODEL.limbs, MODEL.postures, 0.3, KNOTS, elapsed_s
    )
    for k in range(2):
        for values, those in zip(part_of(bodies, k), learnt[k], strict=True):
            np.testing.assert_allclose(values, those, rtol=1e-9, atol=1e-12)
        assert_is_relaxed(part_of(tracks, k), expected[k], elapsed_s / tuning.BODY_S)


def test_without_axes_of_a_trunk_no_direction_is_usual():
    tracks, bodies, (n_seen, _), place = people_after_a_fit(np.random.default_rng(3), 1)
    person, body = part_of(tracks, 0), part_of(bodies, 0)
    unknown = MODEL.postures._replace(trunk=np.empty(0, np.int64))
    expected = reference.relaxed(
        part_of(tracks, 0), body, (n_seen[0], np.zeros(17)), MODEL.limbs, MODEL.postures, place,
        0.3, 0.05,
    )  # fmt: skip
    weights = np.empty(4)
    moment = moment_of(kernels.locate(KNOTS, 8, weights), weights, 0.3, 0.05)
    anatomy.relax_body(
        person, body, (n_seen[0], np.ones(17)), MODEL.limbs, unknown, moment, anatomy.workspace(24)
    )
    assert_is_relaxed(person, expected, 0.05)


def arm_seen_by_one_camera(rng):
    """Return curves of a shoulder, an elbow of nearly unknown depth and a wrist; the ray to it."""
    arm_m = [[0.468, 3.064, 1.55], [0.419, 3.1, 1.205], [0.276, 3.108, 0.952]]
    x = np.array(arm_m) + rng.normal(0, 0.01, (3, 3))
    ray = np.array([-0.749, -0.610, 0.254]) / np.linalg.norm([-0.749, -0.610, 0.254])
    R, z, c = np.zeros((3, 24, 24)), np.zeros((3, 24)), np.zeros((3, 24))
    kernels.start_all(R, z, c, x, np.array([0.02, 1.3, 0.02]), 0.1, np.full(3, 20.0), 0)
    weights, rows, right = np.empty(4), np.empty((3, 24)), np.empty(3)
    span = kernels.locate(KNOTS, 8, weights)
    seen = (np.eye(3) - np.outer(ray, ray)) / 0.012**2
    kernels.fold_gaussian(R[1], z[1], seen, np.zeros(3), 1e-3, x[1], span, weights, rows, right)
    kernels.control_points(R[1], z[1], c[1])
    return R, z, c, x, ray


def test_limbs_across_the_line_of_sight_do_not_throw_their_joint_away():
    rng = np.random.default_rng(0)
    limbs = limbs_of([[0, 1], [1, 2]], 0.01**2)
    for _ in range(200):
        R, z, c, x, ray = arm_seen_by_one_camera(rng)
        cov_m2, after = np.empty((1, 3, 3, 3)), x[None].copy()
        kernels.covariance_all(R[None], KNOTS, cov_m2)
        kernels.constrain_all(
            kernels.Trajectories(R[None], z[None], c[None], after, cov_m2),
            kernels.Bodies(
                np.array([[0.28, 0.25]]), np.array([[0.042, 0.0375]]) ** 2, np.array([[0.0, 1.0]])
            ),
            (np.array([[2, 1, 2]]), np.zeros((1, 3))), limbs, NO_POSTURES, 0.3, KNOTS, 0.05,
        )  # fmt: skip
        assert np.linalg.norm(after[0, 1] - x[1]) < 0.2
        assert np.sqrt(ray @ cov_m2[0, 1] @ ray) > 0.1  # the depth is still said to be uncertain


def test_feet_that_nobody_sees_stay_under_somebody_who_walks_on_and_move_no_knees():
    scene = made([path((0, -2, 0), (4, 2, 0))], seconds=4.0)
    ankles = [COCO17.index("left_ankle"), COCO17.index("right_ankle")]

    def hidden(view):
        xy_px = view.xy_px.copy()
        xy_px[:, ankles] = np.nan
        return replace(view, xy_px=xy_px)

    tracker, off_m = Tracker(scene.rig), []
    for one in frame_sets(scene):
        views = tuple(map(hidden, one.views)) if one.t_s > 1.0 else one.views
        said = tracker.step(FrameSet(one.t_s, views))
        if one.t_s > 2.0:
            off_m.append(np.linalg.norm(said.xyz_m[0] - truth_at(scene, said.t_s)[0], axis=-1))
    knees = [COCO17.index("left_knee"), COCO17.index("right_knee")]
    assert np.max(np.array(off_m)[:, ankles]) < 0.3
    assert np.max(np.array(off_m)[:, knees]) < 0.1


@pytest.mark.parametrize("worse", [0, 1])
def test_a_limb_that_is_far_off_brings_its_less_certain_end_back_and_says_so(worse):
    x = np.array([[0.0, 0, 0], [1.5, 0, 0]])
    cov = np.tile(np.eye(3) * 1e-4, (2, 1, 1))
    cov[worse] *= 4.0
    before = x.copy()
    lengths.tighten(x, cov, limbs_of([[0, 1]]), body_of(np.array([0.4]), np.zeros(1)))
    assert np.linalg.norm(x[1] - x[0]) == pytest.approx(0.4, abs=0.01)
    assert np.linalg.norm((x - before)[1 - worse]) < 0.02
    sigma_m = np.sqrt(np.trace(cov, axis1=1, axis2=2) / 3)
    assert sigma_m[worse] > (1.5 - 0.4) / tuning.LIMB_GATE - 0.02
    assert sigma_m[1 - worse] < 0.02


def test_the_limbs_of_somebody_whom_four_cameras_see_keep_their_lengths():
    scene = made([ACROSS])
    tracker = Tracker(scene.rig)
    snapshots = [tracker.step(s) for s in frame_sets(scene)]
    shin = [
        np.linalg.norm(s.xyz_m[0, COCO17.index("left_knee")] - s.xyz_m[0, 15])
        for s in snapshots[50:]
        if len(s.id)
    ]
    assert np.std(shin) < 0.01


def test_stiffness_is_what_the_acceleration_of_a_spline_asks_for():
    """Second difference over knot squared is the acceleration; its variance is q over knot."""
    settings = FusionSettings(knot_s=0.2, accel_torso=3.0)
    weight = stiffness(COCO17, settings)[COCO17.index("left_hip")]
    sigma_second_difference_m = 3.0 / np.sqrt(0.2) * 0.2**2
    assert np.isclose(weight, 1 / sigma_second_difference_m)


def test_a_person_found_again_by_a_second_camera_keeps_the_identity():
    """After two seconds before one camera alone, the other cameras put the person right."""
    scene = made([ACROSS])
    eye = scene.rig.names[0]
    sets = [only(s, {eye}) if 2 < s.t_s < 4 else s for s in frame_sets(scene)]
    tracker = Tracker(scene.rig, FusionSettings(single_view_death_s=60.0))
    result = outcome(scene, [tracker.step(s) for s in sets if s.views])
    assert result.ids == {0}
    assert np.nanmean(result.error_m[-25:]) < 0.05


def test_a_head_that_nobody_saw_for_seconds_is_where_it_is_once_two_cameras_see_it_again():
    """However far it has gone astray meanwhile, as nothing but limbs held it."""
    head = [0, 1, 2, 3, 4]
    scene = made([path((0, -2, 0), (3, 0.5, 0.2), (6, 1.0, 2.0))], cameras=2)
    sets = [
        FrameSet(s.t_s, tuple(blind_to(v, head) if 1.5 < s.t_s < 4.5 else v for v in s.views))
        for s in frame_sets(scene)
    ]
    tracker = Tracker(scene.rig)
    snapshots = [tracker.step(s) for s in sets]
    again = [s for s in snapshots if 5.0 < s.t_s < 5.9]
    off_m = [
        np.linalg.norm(s.xyz_m[0, head] - truth_at(scene, s.t_s)[0, head], axis=1) for s in again
    ]
    assert len(again) > 15
    assert np.max(off_m) < 0.15
