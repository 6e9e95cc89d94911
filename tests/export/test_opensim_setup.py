"""The files beside TRC open in OpenSim."""

from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

from made_motion import exported, two_walkers
from trecsim.errors import InputError
from trecsim.export.axes import MARKERS


def test_the_files_name_markers_that_the_trc_file_has(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    done = exported(tracks, tmp_path / "walk.trc", opensim=True)
    assert [file.name for file in done.files] == [
        "walk_3.trc", "walk_7.trc", "walk_markers.xml", "walk_3_scaling.xml", "walk_3_ik.xml",
        "walk_7_scaling.xml", "walk_7_ik.xml",
    ]  # fmt: skip
    placed = {one.get("name") for one in Xml.parse(done.files[2]).iter("Marker")}
    assert placed == set(MARKERS[5:])
    scaling = Xml.parse(done.files[3])
    pairs = [one.text.split() for one in scaling.iter("markers") if one.text]
    assert {marker for pair in pairs for marker in pair} <= placed
    assert scaling.findtext(".//marker_set_file") == "walk_markers.xml"
    assert scaling.findtext(".//marker_file") == "walk_3.trc"


def test_only_trc_has_them(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(InputError, match="--opensim belongs to TRC"):
        exported(tracks, tmp_path / "walk.c3d", opensim=True)


def test_opensim_opens_them(tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed")
    tracks, t_s, _ = two_walkers(tmp_path)
    done = exported(tracks, tmp_path / "walk.trc", opensim=True)
    markers = opensim.MarkerSet(str(done.files[2]))
    assert markers.getSize() == 12
    assert markers.get("RHip").getParentFrameName() == "/bodyset/femur_r"
    scaling = opensim.ScaleTool(str(done.files[3]))
    measures = scaling.getModelScaler().getMeasurementSet()
    assert {measures.get(at).getName() for at in range(measures.getSize())} == {
        "thigh", "shank", "upper_arm", "forearm", "trunk", "pelvis",
    }  # fmt: skip
    assert scaling.getModelScaler().getMarkerFileName().endswith("walk_3.trc")
    kinematics = opensim.InverseKinematicsTool(str(done.files[4]), False)
    assert kinematics.getEndTime() == pytest.approx(t_s[-1])
    assert kinematics.getIKTaskSet().getSize() == 12
