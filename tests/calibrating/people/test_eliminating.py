"""The adjustment's kernels beside slow, obvious twins."""

import dataclasses

import numpy as np
import pytest

from trecsim.calibrating.people.adjusting import Adjusted, _moved, _workspace
from trecsim.calibrating.people.kernels.eliminating import reduce
from trecsim.calibrating.people.kernels.looking import look, total_cost, trust
from trecsim.calibrating.people.kernels.unknowns import Sights, Unknowns
from trecsim.calibrating.people.observations import Observations
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tuning import BIAS_S, LEAST_VARIANCE, MOST_VARIANCE, NOISE_PX
from trecsim.calibrating.people.variances import with_own_variances
from trecsim.geometry.rigid import rigid_motion, rotation_matrix

CAMERAS = 3


def scene(seed=0, lens=False):
    """Return two series of a few points in two blocks each, and unknowns that do not fit."""
    rng = np.random.default_rng(seed)
    T = np.stack(
        [
            rigid_motion(rotation_matrix(rng.normal(0, 0.2, 3)), np.array([x, 0.3, 4.0]))
            for x in (-1.0, 0.2, 1.1)
        ]
    )
    points, first, cam = 8, [0], []
    for p in range(points):
        seen = range(CAMERAS) if p % 3 else (0, 2)
        cam.extend(seen)
        first.append(len(cam))
    n = len(cam)
    sights = Sights(
        np.array([0, 4, 8]),
        np.array([0, 2, 4]),
        np.array([1e-4, 2e-4]),
        np.array([4e-4, 3e-4]),
        np.array([1e-3, 9e-3]),
        np.array([0.0, 3.0, 0.0, 6.0]),
        np.array([0, 0, 1, 1, 2, 2, 2, 3]),
        np.array(first),
        np.array(cam),
        rng.normal(0, 0.2, (n, 2)),
        rng.normal(0, 0.3, (n, 2)),
        rng.normal(0, 5.0, n),
        np.array([900.0, 1000.0, 1100.0]),
    )
    unknowns = Unknowns(
        T,
        rng.normal(0, 1e-2, (CAMERAS, 2)) * [1.0, 1e-3],
        rng.normal(0, 1e-2, (CAMERAS, 3)) * lens,
        rng.normal(0, 0.5, (points, 3)),
        rng.normal(0, 0.1, 2),
        rng.normal(0, 0.02, (4, CAMERAS, 2)),
    )
    seen = Observations(sights, np.zeros(2, np.int64), np.array([0, 11]), np.arange(8.0))
    return seen, unknowns


def off(sights, unknowns, o, p):
    """Return the residual of an observation, without bias, and its depth."""
    e = np.empty(2)
    depth = look(sights, unknowns, o, unknowns.xyz_m[p], 11, e, np.empty((2, 3)), np.empty((2, 11)))
    return e / depth, depth


@pytest.mark.parametrize("lens", [False, True])
def test_derivatives_are_those_by_finite_differences(lens):
    seen, unknowns = scene(lens=lens)
    p, o = 1, 3
    e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
    depth = look(seen.sights, unknowns, o, unknowns.xyz_m[p], 11, e, by_point, by_own)
    for m in range(11):
        step = np.zeros(CAMERAS * 11)
        step[seen.sights.cam[o] * 11 + m] = 1e-6
        there = [off(seen.sights, cameras_moved(unknowns, s * step), o, p)[0] for s in (1, -1)]
        np.testing.assert_allclose(
            by_own[:, m], -depth * (there[0] - there[1]) / 2e-6, rtol=1e-5, atol=1e-6
        )
    for a in range(3):
        there = []
        for sign in (1, -1):
            moved = unknowns._replace(xyz_m=unknowns.xyz_m.copy())
            moved.xyz_m[p, a] += sign * 1e-6
            there.append(off(seen.sights, moved, o, p)[0])
        np.testing.assert_allclose(
            by_point[:, a], -depth * (there[0] - there[1]) / 2e-6, rtol=1e-5, atol=1e-6
        )


def cameras_moved(unknowns, step):
    """Return the unknowns with the cameras moved as the adjustment moves them."""
    then = Unknowns(*(array.copy() for array in unknowns))
    for c, change in enumerate(step.reshape(CAMERAS, -1)):
        turn = rotation_matrix(change[:3])
        then.T[c, :3, :3] = turn @ unknowns.T[c, :3, :3]
        then.T[c, :3, 3] = turn @ unknowns.T[c, :3, 3] + change[3:6]
        then.clock[c] += change[6:8]
        if len(change) > 8:
            then.lens[c] += change[8:]
    return then


def outward(sights, unknowns, p, own, at_point, force):
    """Yield places and values of the force on all logarithms of depth over focal length."""
    cameras = sights.cam[sights.first[p] : sights.first[p + 1]]
    for c in cameras:
        x, y, z = unknowns.T[c, :3, :3] @ unknowns.xyz_m[p] + unknowns.T[c, :3, 3]
        share = force / len(cameras)
        yield c * own, share * np.array([y, -x, 0.0, 0.0, 0.0, 1.0]) / z
        yield at_point + 3 * p, share * unknowns.T[c, 2, :3] / z
        if own > 8:
            yield c * own + 8, np.array([-share / (1.0 + unknowns.lens[c, 0])])


def dense(seen, unknowns, own):
    """Return the whole normal matrix and right-hand side: cameras, points, biases, heights."""
    sights = seen.sights
    points, blocks, series = len(sights.block), len(sights.gap_s), len(seen.joint)
    at_point = CAMERAS * own
    at_bias = at_point + 3 * points
    at_level = at_bias + blocks * CAMERAS * 2
    n = at_level + series
    A, b = np.zeros((n, n)), np.zeros(n)

    def add(J, e, w):
        nonlocal A, b
        A += w * np.outer(J, J)
        b += w * e * J

    for s in range(series):
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            block = sights.block[p]
            for o in range(sights.first[p], sights.first[p + 1]):
                c = sights.cam[o]
                e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
                depth = look(sights, unknowns, o, unknowns.xyz_m[p], own, e, by_point, by_own)
                e -= unknowns.bias_m[block, c]
                pixel_m = NOISE_PX * depth / sights.focal_px[c]
                sure = 1 / (sights.noise_m2[s] + pixel_m**2)
                w = sure * trust(sure * (e @ e))
                for a in range(2):
                    J = np.zeros(n)
                    J[c * own : (c + 1) * own] = by_own[a, :own]
                    J[at_point + 3 * p : at_point + 3 * p + 3] = by_point[a]
                    J[at_bias + 2 * (block * CAMERAS + c) + a] = 1.0
                    add(J, e[a], w)
            J = np.zeros(n)
            J[at_point + 3 * p + 2], J[at_level + s] = 1.0, -1.0
            high = unknowns.level_m[s] - unknowns.xyz_m[p, 2]
            by_height = trust(high**2 / sights.level_m2[s]) / sights.level_m2[s]
            add(J, high, by_height)
            for at, force in outward(sights, unknowns, p, own, at_point, by_height * high**2):
                b[at : at + len(force)] += force
        for block in range(sights.block_first[s], sights.block_first[s + 1]):
            begins = block == sights.block_first[s]
            kept = 0.0 if begins else np.exp(-sights.gap_s[block] / BIAS_S)
            for i in range(CAMERAS * 2):
                J = np.zeros(n)
                J[at_bias + 2 * CAMERAS * block + i] = 1.0
                step = unknowns.bias_m[block].ravel()[i]
                if not begins:
                    J[at_bias + 2 * CAMERAS * (block - 1) + i] = -kept
                    step -= kept * unknowns.bias_m[block - 1].ravel()[i]
                add(J, -step, 1 / (sights.bias_m2[s] * (1 - kept**2)))
    return A, b, at_point


@pytest.mark.parametrize(("own", "lens"), [(8, False), (11, True)])
def test_what_is_eliminated_step_by_step_is_the_schur_complement(own, lens):
    seen, unknowns = scene(lens=lens)
    A, b, border = dense(seen, unknowns, own)
    inner = np.linalg.inv(A[border:, border:])
    expected = A[:border, :border] - A[:border, border:] @ inner @ A[border:, :border]
    work = _workspace(seen, CAMERAS, own)
    normal, right = np.zeros((border, border)), np.zeros(border)
    reduce(seen.sights, unknowns, 1.0, 0.0, normal, right, work)
    scale = np.sqrt(np.outer(np.diag(A)[:border], np.diag(A)[:border]))
    np.testing.assert_allclose(normal / scale, expected / scale, atol=2e-5)
    expected_right = b[:border] - A[:border, border:] @ inner @ b[border:]
    spread = np.sqrt(np.diag(scale))
    np.testing.assert_allclose(right / spread, expected_right / spread, atol=2e-4)


def test_the_inner_unknowns_after_a_step_solve_the_whole_system():
    seen, unknowns = scene()
    A, b, border = dense(seen, unknowns, 8)
    A[np.arange(border), np.arange(border)] += 10.0
    whole = np.linalg.solve(A, b)
    work = _workspace(seen, CAMERAS, 8)
    normal, right = np.zeros((border, border)), np.zeros(border)
    reduce(seen.sights, unknowns, 1.0, 0.0, normal, right, work)
    then = _moved(seen, unknowns, whole[:border], work, 8)
    np.testing.assert_allclose(
        (then.xyz_m - unknowns.xyz_m).ravel(), whole[border : border + 24], rtol=1e-3, atol=1e-4
    )
    np.testing.assert_allclose(
        (then.bias_m - unknowns.bias_m).ravel(), whole[border + 24 : -2], rtol=1e-3, atol=1e-4
    )
    np.testing.assert_allclose(then.level_m - unknowns.level_m, whole[-2:], rtol=1e-3, atol=1e-4)


def reduced(seen, unknowns, own=8):
    """Return the equations of the cameras, and what is kept of the elimination."""
    work = _workspace(seen, CAMERAS, own)
    n = CAMERAS * own
    normal, right = np.zeros((n, n)), np.zeros(n)
    reduce(seen.sights, unknowns, 1.0, 0.0, normal, right, work)
    return normal, right, work


def test_the_cost_falls_along_the_step_of_the_equations():
    seen, unknowns = scene(seed=4)
    normal, right, work = reduced(seen, unknowns)
    step = np.linalg.solve(normal + 1e3 * np.diag(np.diag(normal)), right)
    before = total_cost(seen.sights, unknowns, 1.0, work)
    after = total_cost(seen.sights, _moved(seen, unknowns, step, work, 8), 1.0, work)
    assert after < before


@pytest.mark.parametrize("own", [8, 11])
def test_the_equations_are_the_gradient_of_the_cost_with_the_depths_of_its_beginning(own):
    seen, unknowns = nearly_right(*scene(seed=2, lens=own > 8))
    settled = settle(seen, unknowns, own)  # so that the inner unknowns have no gradient
    _, right, work = reduced(seen, settled, own)
    assert (work.draw > 0.0).all()
    for m in range(CAMERAS * own):
        step = np.zeros(CAMERAS * own)
        step[m] = 1e-6
        there = [
            total_cost(seen.sights, cameras_moved(settled, sign * step), 1.0, work)
            for sign in (1, -1)
        ]
        slope = (there[0] - there[1]) / 2e-6
        assert -0.5 * slope == pytest.approx(right[m], rel=2e-2, abs=2e-2 * np.abs(right).max())


def nearly_right(seen, unknowns):
    """Return observations of what the unknowns predict, with errors of some mm."""
    z, rng = seen.sights.z.copy(), np.random.default_rng(0)
    for p in range(8):
        for o in range(seen.sights.first[p], seen.sights.first[p + 1]):
            z[o] -= off(seen.sights, unknowns, o, p)[0] + rng.normal(0.0, 2e-3, 2)
    return dataclasses.replace(seen, sights=seen.sights._replace(z=z)), unknowns


def settle(seen, unknowns, own):
    """Return the unknowns with points, biases and heights at their best for these cameras."""
    for _ in range(60):
        _, _, work = reduced(seen, unknowns, own)
        unknowns = _moved(seen, unknowns, np.zeros(CAMERAS * own), work, own)
    return unknowns


def test_people_are_not_drawn_towards_the_cameras():
    """Scaling all about one camera changes no direction it sees: its forces must cancel."""
    seen, unknowns = nearly_right(*scene(seed=3))
    unknowns = settle(seen, unknowns, 8)
    _, right, _ = reduced(seen, unknowns)
    shift = unknowns.T[:, :3, 3].copy()
    outward = np.zeros(CAMERAS * 8)
    for c in range(CAMERAS):
        outward[c * 8 + 3 : c * 8 + 6] = shift[c]
    # moving all cameras and (as they follow) points outward alike is no gain and no loss
    assert abs(right @ outward) < 0.02 * np.abs(right * outward).sum()


def test_variances_found_are_those_of_the_observations_that_were_adjusted():
    seen, unknowns = scene()
    adjusted = Adjusted(RigState.empty(CAMERAS), unknowns, np.eye(24), 0.0)
    fewer = dataclasses.replace(
        seen,
        sights=seen.sights._replace(gap_s=seen.sights.gap_s[:3], block_first=np.array([0, 2, 3])),
    )
    mended = with_own_variances(seen, adjusted, fewer).sights
    ratio = mended.bias_m2 / seen.sights.bias_m2
    assert ratio[0] == pytest.approx(ratio[1])
    assert LEAST_VARIANCE <= ratio[0] <= MOST_VARIANCE
    np.testing.assert_allclose(with_own_variances(seen, adjusted).sights.bias_m2, mended.bias_m2)
