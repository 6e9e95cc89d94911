"""2D poses of AlphaPose, DeepLabCut and SLEAP."""

import json
from pathlib import Path

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.sources import read_poses
from trecsim.values import Poses2D

PARTS = ["LShoulder", "RShoulder", "left_hip", "right_hip", "KneeLeft", "right knee", "tail"]
JOINTS = ["left_shoulder", "right_shoulder", "left_hip", "right_hip", "left_knee", "right_knee"]


def place(frame: int, part: int, person: int = 0) -> tuple[float, float]:
    return 100.0 * person + 10.0 * part + frame, 50.0 + part


def write_deeplabcut(path: Path, people: int) -> Path:
    cells = [
        (who, part, axis) for who in range(people) for part in range(len(PARTS)) for axis in "xyl"
    ]
    axes = {"x": "x", "y": "y", "l": "likelihood"}
    lines = [",".join(["scorer", *("model" for _ in cells)])]
    if people > 1:
        lines.append(",".join(["individuals", *(f"person{who}" for who, _, _ in cells)]))
    lines.append(",".join(["bodyparts", *(PARTS[part] for _, part, _ in cells)]))
    lines.append(",".join(["coords", *(axes[axis] for _, _, axis in cells)]))
    for frame in range(3):
        row = [f"labeled-data/v/img{frame:03d}.png" if people > 1 else str(frame)]
        for who, part, axis in cells:
            x, y = place(frame, part, who)
            row.append({"x": f"{x}", "y": f"{y}", "l": "0.9"}[axis])
        if frame == 1:
            row[1 : 1 + 3 * len(PARTS)] = [""] * (3 * len(PARTS))  # the first is not seen
        lines.append(",".join(row))
    path.write_text("\n".join(lines) + "\n")
    return path


def write_sleap(path: Path) -> Path:
    head = ["track", "frame_idx", "instance.score"]
    head += [f"{part}.{axis}" for part in PARTS for axis in ("x", "y", "score")]
    lines = [",".join(head)]
    for frame, who in ((0, 0), (0, 1), (1, 1), (3, 0)):
        row = [f"track_{who}", str(frame), "0.7"]
        for part in range(len(PARTS)):
            x, y = place(frame, part, who)
            row += [f"{x}", f"{y}", "0.9"]
        lines.append(",".join(row))
    path.write_text("\n".join(lines) + "\n")
    return path


def check(image: Poses2D, frame: int, people: list[int]) -> None:
    assert image.t_s == pytest.approx(frame / 25.0)
    assert len(image.xy_px) == len(people)
    for row, who in enumerate(people):
        for part, joint in enumerate(JOINTS):
            at = COCO17.index(joint)
            assert image.xy_px[row, at].tolist() == list(place(frame, part, who))
            assert image.score[row, at] == pytest.approx(0.9)
        assert np.isnan(image.xy_px[row, COCO17.index("nose")]).all()


def test_deeplabcut_of_one_person(tmp_path: Path) -> None:
    file = write_deeplabcut(tmp_path / "cam1.csv", 1)
    images = list(read_poses(file, fps=25.0))
    check(images[0], 0, [0])
    check(images[1], 1, [])
    check(images[2], 2, [0])
    assert {image.camera for image in images} == {"cam1"}


def test_deeplabcut_of_several_people(tmp_path: Path) -> None:
    images = list(read_poses(write_deeplabcut(tmp_path / "cam1.csv", 2), fps=25.0))
    check(images[0], 0, [0, 1])
    check(images[1], 1, [1])


def test_sleap_and_a_folder_of_cameras(tmp_path: Path) -> None:
    write_sleap(tmp_path / "cam1.csv")
    write_deeplabcut(tmp_path / "cam2.csv", 1)
    images = [image for image in read_poses(tmp_path, fps=25.0) if image.camera == "cam1"]
    check(images[0], 0, [0, 1])
    check(images[1], 1, [1])
    check(images[2], 2, [])  # the other camera has this frame
    check(images[3], 3, [0])
    assert images[0].person_score.tolist() == [0.7, 0.7]


def test_alphapose(tmp_path: Path) -> None:
    entries = [
        {
            "image_id": f"{frame}.jpg", "category_id": 1, "score": 2.9, "idx": [who],
            "box": [0.0, 0.0, 9.0, 9.0],
            "keypoints": [v for j in range(17) for v in (*place(frame, j, who), 0.9)],
        }
        for frame in (0, 1)
        for who in (0, 1)
    ]  # fmt: skip
    file = tmp_path / "cam1.json"
    file.write_text(json.dumps(entries))
    images = list(read_poses(file, fps=25.0))
    assert [image.t_s for image in images] == [0.0, 0.04]
    assert images[1].xy_px[1, 3].tolist() == list(place(1, 3, 1))
    assert images[0].person_score.tolist() == pytest.approx([0.9, 0.9])


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("0,1.0,x,0.9", "expected a number in column 3"),
        ("nothing,1.0,2.0,0.9", "expected the number of a frame"),
        ("1,1e9,2.0,0.9", "is beyond"),
    ],
)
def test_faults_are_told_with_their_line(line: str, text: str, tmp_path: Path) -> None:
    file = write_deeplabcut(tmp_path / "cam1.csv", 1)
    file.write_text(file.read_text() + line + "\n")
    with pytest.raises(InputError, match=text) as fault:
        list(read_poses(file, fps=25.0))
    assert "line 7" in str(fault.value)


def test_a_table_without_joints_of_people_is_told_what_it_lacks(tmp_path: Path) -> None:
    file = tmp_path / "cam1.csv"
    file.write_text("scorer,m,m,m\nbodyparts,tail,tail,tail\ncoords,x,y,likelihood\n0,1,2,0.9\n")
    with pytest.raises(InputError, match="named like the joints of COCO-17"):
        list(read_poses(file, fps=25.0))
    file.write_text("t_s,person,joint\n0.0,1,nose\n")
    with pytest.raises(InputError):
        list(read_poses(file, fps=25.0))
