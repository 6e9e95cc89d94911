"""The simulated detector errs as a real one does: OpenPose on Shelf, as it was measured there.

Every figure agrees within 10 %, two kinds excepted: swaps of left and right happen once in 250
people, so that even thousands of images tell their share only roughly (30 %); and the error that
one in a hundred joints exceeds, per kind of joint, rests on few (20 %). That of all joints together
is held to 10 % as well.
"""

from pathlib import Path

import pytest

from detector.openpose_on_shelf import MEASURED, recorded, simulated
from harness.figures import find, stored
from trecsim.lab.simulation.detector_errors import ANNOTATED

RARE = {"left and right swapped": 0.3} | {name: 0.2 for name in MEASURED if name.endswith("p99 px")}


@pytest.fixture(scope="module")
def figures() -> dict[str, float]:
    return simulated(ANNOTATED, seed=1)


def test_the_simulated_detector_errs_as_the_measured_one(figures: dict[str, float]) -> None:
    assert {
        name: (figures[name], measured)
        for name, measured in MEASURED.items()
        if figures[name] != pytest.approx(measured, rel=RARE.get(name, 0.1))
    } == {}


def test_the_page_about_the_detector_tells_the_figures(figures: dict[str, float]) -> None:
    page = Path(__file__).parents[2] / "docs" / "reference" / "simulated-detector.md"
    table = page.read_text().split("<!-- table")[1].split("<!-- end")[0].strip()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[4:]]
    assert [row[0] for row in rows] == list(MEASURED)
    for name, measured, _, annotated, *_ in rows:
        assert float(measured) == MEASURED[name]
        # The page has the mean over seeds, which a single one meets as nearly as the real figure.
        assert float(annotated) == pytest.approx(figures[name], rel=RARE.get(name, 0.1)), name


def test_the_recording_gives_the_figures_that_are_stored_of_it(shared_data: Path) -> None:
    result = stored("detector_figures")
    assert result is not None
    for name, here in recorded(shared_data / "shelf").items():
        figure = find(result.figures, (name, "here"))
        assert figure is not None
        assert figure.value == pytest.approx(here, rel=0.01), name


def test_the_recording_gives_about_the_figures_that_the_simulator_is_tuned_to() -> None:
    result = stored("detector_figures")
    assert result is not None
    for name, measured in MEASURED.items():
        figure = find(result.figures, (name, "here"))
        assert figure is not None
        rare = "p99" in name or name in ("left and right swapped", "white part px")
        bound = 0.55 if rare else 0.25 if "missing" in name else 0.12
        assert figure.value == pytest.approx(measured, rel=bound), name
