"""The tracker's numbers of detectors and bodies are its own, not those of the simulator."""

import numpy as np
import pytest

from trecsim.fusion import FusionSettings
from trecsim.fusion.body import key_point_sigma_m, usual_body
from trecsim.fusion.visibility import silhouette
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.detector_errors import ANNOTATED, REAL, Detector
from trecsim.lab.simulation.kernels import body_volume
from trecsim.skeleton import COCO17

LIMBS = slice(5, 17, 2)  # shoulder, elbow, wrist, hip, knee, ankle
SIGMA_M = key_point_sigma_m(COCO17, FusionSettings())


def test_the_noise_of_the_limbs_is_the_setting_on_average_and_hips_have_most() -> None:
    assert SIGMA_M[LIMBS].mean() == pytest.approx(FusionSettings().joint_sigma_m)
    assert SIGMA_M.argmax() == COCO17.index("left_hip")
    np.testing.assert_allclose(SIGMA_M[:5], FusionSettings().joint_sigma_m)


@pytest.mark.parametrize("detector", [REAL, ANNOTATED])
def test_the_joints_err_in_other_proportions_than_those_of_the_simulated_detector(
    detector: Detector,
) -> None:
    simulated = np.array(detector.sigma)[LIMBS]
    proportion = SIGMA_M[LIMBS] / SIGMA_M[LIMBS].mean() / (simulated / simulated.mean())
    assert np.abs(np.log(proportion)).max() > 0.1


def test_no_limb_and_no_capsule_has_the_simulators_size() -> None:
    average = body(1.75)
    simulated_m = [
        average.shin_m, average.thigh_m, average.upper_arm_m, average.forearm_m, average.hips_m,
        average.shoulders_m,
    ]  # fmt: skip
    usual = usual_body(COCO17)
    assert not np.isclose(usual.length_m[usual.bone][:, None], simulated_m, atol=1e-3).any()
    radius_m = silhouette(COCO17).radius_m
    assert not np.isclose(radius_m[:, None], body_volume.RADIUS_M, atol=1e-3).any()
