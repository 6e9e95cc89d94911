import numpy as np
import pytest

from made_rigs import LENSES
from trecsim.calibrating.lens_fitting import COEFFICIENT_NAMES, bend, distortion_model
from trecsim.geometry.distortion import lens

POINTS = np.random.default_rng(5).uniform(-0.6, 0.6, (40, 2))


@pytest.mark.parametrize("model", ["brown", "rational", "fisheye"])
def test_the_lens_that_is_fitted_is_the_one_of_the_cameras(model):
    expected, by_point = lens(distortion_model(model), LENSES[model]).distort_with_jacobian(POINTS)
    bent, found, _ = bend(model, LENSES[model], POINTS)
    np.testing.assert_allclose(bent, expected, atol=1e-12)
    np.testing.assert_allclose(found, by_point, atol=1e-9)


@pytest.mark.parametrize("model", ["brown", "rational", "fisheye"])
def test_the_derivative_by_the_coefficients_is_that_of_finite_differences(model):
    values = LENSES[model]
    _, _, by_values = bend(model, values, POINTS)
    for number in range(len(COEFFICIENT_NAMES[model])):
        step = np.zeros(len(values))
        step[number] = 1e-6
        difference = bend(model, values + step, POINTS)[0] - bend(model, values - step, POINTS)[0]
        np.testing.assert_allclose(by_values[:, :, number], difference / 2e-6, atol=1e-8)
