import dataclasses

import numpy as np
import pytest

from made_rigs import LENSES, camera, look_at
from trecsim.geometry.camera import Camera
from trecsim.geometry.view import field_of_view_deg, image_margin, rays, share_without_inverse

K = np.array([[960.0, 0.0, 959.5], [0.0, 960.0, 539.5], [0.0, 0.0, 1.0]])


def looking_down(height_m=4.0):
    T = look_at(np.array([2.0, 1.0, height_m]), np.array([2.0, 1.0, 0.0]), up=(0.0, 1.0, 0.0))
    return Camera("down", (1920, 1080), K, T)


@pytest.mark.parametrize("lens", LENSES)
def test_points_along_a_ray_project_to_its_pixel(lens):
    cam = camera(lens=lens)
    xy_px = np.random.default_rng(0).uniform([50, 50], [1870, 1030], (20, 2))
    xyz_m = cam.position_m + 3.0 * rays(cam, xy_px)
    np.testing.assert_allclose(np.linalg.norm(rays(cam, xy_px), axis=-1), 1.0)
    np.testing.assert_allclose(cam.project(xyz_m), xy_px, atol=1e-6)


def test_the_field_of_view_of_a_pinhole_is_known():
    angle_deg, complete = field_of_view_deg(looking_down())
    assert angle_deg == pytest.approx(90.0)
    assert complete


def test_the_field_of_view_of_a_shifted_image_is_the_sum_of_both_sides():
    shifted = K.copy()
    shifted[0, 2] = -0.5
    cam = dataclasses.replace(looking_down(), K=shifted)
    assert field_of_view_deg(cam)[0] == pytest.approx(np.rad2deg(np.arctan(2.0)))


def test_a_lens_that_folds_back_before_the_border_is_told():
    coefficients = np.array([-0.4, 0.0, 0.0, 0.0, 0.0])
    cam = dataclasses.replace(looking_down(), distortion_model="brown", distortion=coefficients)
    angle_deg, complete = field_of_view_deg(cam)
    assert not complete
    fold_deg = 2 * np.rad2deg(np.arctan(np.sqrt(1 / 1.2)))
    assert 0.9 * fold_deg < angle_deg < fold_deg
    assert 0.3 < share_without_inverse(cam) < 0.7
    assert share_without_inverse(looking_down()) == 0.0


def test_the_margin_tells_what_is_in_the_image_and_how_far():
    # From 4 m above, 960 px of focal length see 1920 px as 8 m.
    floor_m = np.array([[2.0, 1.0, 0], [5.0, 1.0, 0], [6.0, 1.0, 0], [7.0, 1.0, 0], [2.0, 3.5, 0]])
    expected = [540 / 1920, 0.125, 0.0, -0.125, -60 / 1920]
    np.testing.assert_allclose(image_margin(looking_down(), floor_m), expected, atol=1e-12)


def test_a_point_without_an_image_is_out_of_view():
    assert image_margin(looking_down(), np.array([2.0, 1.0, 5.0])) == -1.0
