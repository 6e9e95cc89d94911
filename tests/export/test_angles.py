"""Joint angles of poses whose angles are known."""

import csv
from pathlib import Path

import numpy as np
import pytest

from made_motion import exported, two_walkers
from made_people import STANDING_M
from trecsim.export.angles import ANGLES, joint_angles_deg
from trecsim.skeleton import COCO17


def turned(angle_deg: float, axis: str) -> np.ndarray:
    """Return the rotation about an axis of the world."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(3)
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
    return turn


def moved(joints: list[str], about: str, turn: np.ndarray) -> np.ndarray:
    """Return the person who stands and looks along x, with some joints turned about another."""
    xyz_m = STANDING_M.copy()
    centre = xyz_m[COCO17.index(about)].copy()
    rows = [COCO17.index(joint) for joint in joints]
    xyz_m[rows] = (xyz_m[rows] - centre) @ turn.T + centre
    return xyz_m


def angles(xyz_m: np.ndarray) -> dict[str, float]:
    found = joint_angles_deg(xyz_m[None])[0].tolist()
    return {one.name: value for one, value in zip(ANGLES, found, strict=True)}


def test_who_stands_has_no_angle() -> None:
    assert all(abs(value) < 1e-6 for value in angles(STANDING_M).values())


UPPER = [name for name in COCO17.joints if not name.endswith(("hip", "knee", "ankle"))]
CASES = [
    ("left_knee_flexion", ["left_ankle"], "left_knee", "y", 50.0, 50.0),
    ("right_knee_flexion", ["right_ankle"], "right_knee", "y", 110.0, 110.0),
    ("left_hip_flexion", ["left_knee", "left_ankle"], "left_hip", "y", -35.0, 35.0),
    ("right_hip_flexion", ["right_knee", "right_ankle"], "right_hip", "y", 20.0, -20.0),
    ("left_hip_adduction", ["left_knee", "left_ankle"], "left_hip", "x", -15.0, 15.0),
    ("right_hip_adduction", ["right_knee", "right_ankle"], "right_hip", "x", -15.0, -15.0),
    ("left_elbow_flexion", ["left_wrist"], "left_elbow", "y", -80.0, 80.0),
    ("right_elbow_flexion", ["right_wrist"], "right_elbow", "y", -10.0, 10.0),
]


@pytest.mark.parametrize(("name", "joints", "about", "axis", "turn", "wanted"), CASES)
@pytest.mark.parametrize("heading_deg", [0.0, 130.0])
def test_one_joint_turned_is_one_angle(
    name: str, joints: list[str], about: str, axis: str, turn: float, wanted: float,
    heading_deg: float,
) -> None:  # fmt: skip
    xyz_m = moved(joints, about, turned(turn, axis)) @ turned(heading_deg, "z").T
    found = angles(xyz_m)
    assert found.pop(name) == pytest.approx(wanted)
    assert all(abs(value) < 1e-6 for value in found.values())


@pytest.mark.parametrize(
    ("axis", "turn", "name", "wanted"),
    [("y", 30.0, "trunk_flexion", 30.0), ("x", 20.0, "trunk_bending", 20.0)],
)
@pytest.mark.parametrize("heading_deg", [0.0, -70.0])
def test_a_trunk_that_leans_is_told_against_the_vertical(
    axis: str, turn: float, name: str, wanted: float, heading_deg: float
) -> None:
    xyz_m = STANDING_M.copy()
    rows = [COCO17.index(joint) for joint in UPPER]
    middle = STANDING_M[[11, 12]].mean(axis=0)
    xyz_m[rows] = (xyz_m[rows] - middle) @ turned(turn, axis).T + middle
    found = angles(xyz_m @ turned(heading_deg, "z").T)
    assert found[name] == pytest.approx(wanted)


def test_shoulders_turned_to_the_left_are_a_rotation_of_the_trunk() -> None:
    xyz_m = STANDING_M.copy()
    rows = [COCO17.index(joint) for joint in UPPER]
    xyz_m[rows] = xyz_m[rows] @ turned(25.0, "z").T
    assert angles(xyz_m)["trunk_rotation"] == pytest.approx(25.0)


def test_an_angle_is_missing_where_its_joint_is() -> None:
    xyz_m = STANDING_M.copy()
    xyz_m[COCO17.index("left_ankle")] = np.nan
    found = angles(xyz_m)
    assert np.isnan(found.pop("left_knee_flexion"))
    assert np.isfinite(list(found.values())).all()


def test_the_tables_hold_the_angles(tmp_path: Path) -> None:
    tracks, t_s, people = two_walkers(tmp_path)
    (file,) = exported(tracks, tmp_path / "o.angles.csv").files
    rows = [row for row in csv.DictReader(file.read_text().splitlines()) if row["person"] == "7"]
    there = np.isfinite(people[7]).any(axis=(1, 2))
    assert [float(row["t_s"]) for row in rows] == t_s[there].tolist()
    wanted = joint_angles_deg(people[7][there])
    for at, one in enumerate(ANGLES):
        found = [float(row[f"{one.name}_deg"]) for row in rows]
        np.testing.assert_allclose(found, wanted[:, at], atol=2e-3)
    file = exported(tracks, tmp_path / "o.mot", person=3).files[0]
    head, _, body = file.read_text().partition("endheader\n")
    assert "nRows=100\nnColumns=12\ninDegrees=yes" in head
    names, *lines = body.splitlines()
    table = np.array([line.split("\t") for line in lines], float)
    extension = names.split("\t").index("lumbar_extension")
    flexion = [one.name for one in ANGLES].index("trunk_flexion")
    wanted = -joint_angles_deg(people[3])[:, flexion]
    np.testing.assert_allclose(table[:, extension], wanted, atol=2e-3)


def test_opensim_reads_the_angles(tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed")
    tracks, t_s, _ = two_walkers(tmp_path)
    file = exported(tracks, tmp_path / "o.mot", person=3).files[0]
    table = opensim.TimeSeriesTable(str(file))
    assert list(table.getColumnLabels()) == [one.opensim for one in ANGLES]
    np.testing.assert_allclose(np.array(table.getIndependentColumn()), t_s, atol=1e-6)
