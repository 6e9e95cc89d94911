"""The simulated detector errs as a real one does: OpenPose on Shelf, as it was measured there.

Every figure agrees within 10 %, two kinds excepted: swaps of left and right happen once in 250
people, so that even thousands of images tell their share only roughly (30 %); and the error that
one in a hundred joints exceeds, per kind of joint, rests on few (20 %). That of all joints together
is held to 10 % as well.
"""

import pytest

from trecsim.evaluation.detector_figures import MEASURED, simulated
from trecsim.simulation.detector import ANNOTATED

RARE = {"left and right swapped": 0.3} | {name: 0.2 for name in MEASURED if name.endswith("p99 px")}


@pytest.fixture(scope="module")
def figures() -> dict[str, float]:
    return simulated(ANNOTATED, seed=1)


@pytest.mark.parametrize("name", MEASURED)
def test_the_simulated_detector_errs_as_the_measured_one(
    name: str, figures: dict[str, float]
) -> None:
    assert figures[name] == pytest.approx(MEASURED[name], rel=RARE.get(name, 0.1))
