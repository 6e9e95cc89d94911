import json

import numpy as np

from made_rigs import ring
from trecsim.calibrating import CalibrationResult, CameraQuality
from trecsim.calibrating.result import Finding, judge
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.cli.terminal import plain
from trecsim.lab.report.calibration_page import write_calibration_report
from trecsim.lab.report.page import Picture, Pictures, Section

RESULT = CalibrationResult(
    (CameraQuality("north", 0.02, 0.003, 0.1, reprojection_px=0.3), CameraQuality("lost <b>")),
    "usable",
    ("camera 'lost' was not found",),
    time_ref_s=4.0,
)


def test_every_camera_stands_in_the_summary_with_null_where_it_was_not_found():
    summary = json.loads(json.dumps(plain(RESULT.summary()), allow_nan=False))
    assert summary["cameras"]["lost <b>"] == dict.fromkeys(
        ("rotation_sd_deg", "position_sd_m", "time_offset_s", "time_drift_ppm", "reprojection_px")
    )
    assert summary["cameras"]["north"]["rotation_sd_deg"] == 0.02
    assert (summary["time_ref_s"], summary["verdict"]) == (4.0, "usable")
    assert summary["reasons"] == ["camera 'lost' was not found"]


def test_one_bad_finding_spoils_the_verdict_and_is_told_first():
    found = [Finding("good", "a"), Finding("wrong", "b"), Finding("usable", "c")]
    assert judge(found) == ("wrong", ("b", "c", "a"))


def test_nothing_looked_at_is_not_good():
    assert judge([])[0] == "wrong"


def test_the_report_is_one_file_with_verdict_cameras_map_and_pictures(tmp_path):
    rig = ring(3)
    extra = Section("Corners", [Pictures([Picture(b"\xff\xd8jpeg", "the board", "first")])])
    out = tmp_path / "report.html"
    covariance = PoseCovariance(np.eye(18) * 1e-6)
    write_calibration_report(
        out, "Rig", RESULT, rig=rig, covariance=covariance, sections=[extra], source="a & b"
    )
    text = out.read_text()
    assert all(
        f"<h2>{title}" in text for title in ("Verdict", "Cameras", "Expected error", "Corners")
    )
    assert "lost &lt;b&gt;" in text
    assert "data:image/jpeg;base64,/9hqcGVn" in text
    assert "usable" in text.lower()
    assert "://" not in text
    assert "drift" not in text.split("<tbody>")[0].split("<thead>")[1]  # a column without numbers
