"""What calibrations write: a rig file and a report, also where nobody asked for one."""

import pytest

from trecsim.calibrating.result import CalibrationResult, CameraQuality
from trecsim.cli import calibration_files
from trecsim.cli.calibration_files import report_of, write_report

RESULT = CalibrationResult((CameraQuality("north"),), "usable", ("more people",))


def test_a_report_lies_beside_its_rig_file(tmp_path):
    page = report_of(tmp_path / "rig.toml", None)
    write_report(page, "Calibration from people", RESULT, asked=False)
    assert "more people" in (tmp_path / "rig.html").read_text().lower()


@pytest.mark.parametrize("asked", [False, True])
def test_without_the_extra_only_a_report_that_was_asked_for_is_an_error(
    tmp_path, monkeypatch, capsys, asked
):
    monkeypatch.setattr(calibration_files, "has_extra", lambda extra: False)
    page = tmp_path / "rig.html"
    write_report(page, "Repaired rig", RESULT, asked=asked)
    assert page.exists() == asked
    assert ("no report" in capsys.readouterr().err) != asked
