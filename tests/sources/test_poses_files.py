import json
import logging

import numpy as np
import pytest

from sources.made_poses import assert_same, made_poses
from trecsim.errors import InputError
from trecsim.sources import coco, read_poses
from trecsim.sources.openpose import MAX_FILE_BYTES, camera_folders
from trecsim.store.poses_writer import PosesWriter


def flat(image, person):
    rows = np.nan_to_num(np.concatenate([image.xy_px, image.score[..., None]], axis=2))[person]
    return rows.ravel().tolist()


def write_openpose(folder, image, name):
    folder.mkdir(parents=True, exist_ok=True)
    people = [
        {"person_id": [-1], "pose_keypoints_2d": flat(image, person), "face_keypoints_2d": []}
        for person in range(len(image.xy_px))
    ]
    (folder / name).write_text(json.dumps({"version": 1.3, "people": people}))


def openpose_name(camera, frame):
    return f"{camera}_{frame:012d}_keypoints.json"


def write_coco(path, images, fps, image_id=int):
    entries = [
        {
            "image_id": image_id(round(image.t_s * fps)),
            "category_id": 1,
            "keypoints": flat(image, person),
            "score": image.person_score[person],
        }
        for image in images
        for person in range(len(image.xy_px))
    ]
    path.write_text(json.dumps(entries))


def same_points(found, expected):
    assert (found.camera, found.t_s) == (expected.camera, pytest.approx(expected.t_s))
    np.testing.assert_array_equal(found.xy_px, expected.xy_px)
    np.testing.assert_array_equal(found.score, expected.score)


@pytest.mark.parametrize("below", [".", "pose"])
def test_openpose_folders_are_merged_by_time(tmp_path, below):
    images = [made_poses("cam01", i / 50, i % 3, i) for i in range(7)]
    others = [made_poses("cam02", i / 50, 1, 50 + i) for i in range(2, 5)]
    for image in images + others:
        frame = round(image.t_s * 50)
        folder = tmp_path / below / f"{image.camera}_json"
        write_openpose(folder, image, openpose_name(image.camera, frame))
    expected = sorted(images + others, key=lambda image: (image.t_s, image.camera))
    found = sorted(read_poses(tmp_path, fps=50), key=lambda image: (image.t_s, image.camera))
    for one, other in zip(found, expected, strict=True):
        same_points(one, other)
    times_s = [image.t_s for image in read_poses(tmp_path, fps=50)]
    assert times_s == sorted(times_s)


@pytest.mark.parametrize(
    "name", ["cam_{:d}.json", "cam01_{:04d}.json", "v2_{:012d}_keypoints.json"]
)
def test_frames_come_in_the_order_of_their_numbers_and_may_lack(tmp_path, name):
    for frame in (0, 2, 10, 9, 100):
        write_openpose(tmp_path / "a_json", made_poses("a", 0, 1), name.format(frame))
    assert [image.t_s for image in read_poses(tmp_path, fps=10)] == [0.0, 0.2, 0.9, 1.0, 10.0]


def test_the_folder_of_one_camera_may_be_given_itself(tmp_path):
    write_openpose(tmp_path / "north_json", made_poses("a", 0, 1), "x_000.json")
    assert list(camera_folders(tmp_path / "north_json")) == ["north"]
    (image,) = read_poses(tmp_path / "north_json", fps=25)
    assert image.camera == "north"


def test_people_without_points_are_left_out(tmp_path):
    people = [{}, {"pose_keypoints_2d": []}, {"pose_keypoints_2d": [0] * 75},
              {"pose_keypoints_2d": [5.0, 6.0, 0.5] * 25}]  # fmt: skip
    (tmp_path / "a_json").mkdir()
    (tmp_path / "a_json" / "a_0.json").write_text(json.dumps({"people": people}))
    (image,) = read_poses(tmp_path, fps=25)
    assert image.person_score.tolist() == [0.5]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "not valid JSON"),
        ('{"people": [', "not valid JSON"),
        ("[]", "expected an object with a list 'people'"),
        ('{"people": {}}', "expected an object with a list 'people'"),
        ('{"people": [7]}', "expected an object with a list 'people'"),
        ('{"people": [{"pose_keypoints_2d": [1, 2, 3]}]}', "person 0: expected x, y, score"),
        ('{"people": [{"pose_keypoints_2d": [NaN]}]}', "NaN is not JSON"),
        ('{"people": ' + "[" * 100_000, "nested too deeply"),
        ("[" + " " * MAX_FILE_BYTES + "]", "larger than"),
    ],
)
def test_a_wrong_openpose_file_is_named(tmp_path, content, message):
    write_openpose(tmp_path / "a_json", made_poses("a", 0, 1), "a_0.json")
    (tmp_path / "a_json" / "a_1.json").write_text(content)
    images = read_poses(tmp_path, fps=25)
    next(images)
    with pytest.raises(InputError, match=r"a_json: a_1\.json: ") as caught:
        next(images)
    assert message in str(caught.value)


def test_two_files_of_one_frame_are_refused(tmp_path):
    for name in ("a_07.json", "b_7.json"):
        write_openpose(tmp_path / "a_json", made_poses("a", 0, 1), name)
    with pytest.raises(InputError, match=r"a_07\.json and b_7\.json are both frame 7"):
        list(read_poses(tmp_path, fps=25))


def test_coco_results_are_read_person_by_person(tmp_path):
    images = [made_poses("north", i / 25, 1 + i % 3, i) for i in range(9)]
    write_coco(tmp_path / "north.json", images, 25)
    for found, expected in zip(read_poses(tmp_path / "north.json", fps=25), images, strict=True):
        same_points(found, expected)
        np.testing.assert_array_equal(found.person_score, expected.person_score)


def test_a_folder_of_coco_results_has_a_camera_a_file(tmp_path):
    for camera in ("north", "south"):
        images = [made_poses(camera, i / 25, 1, i) for i in range(4)]
        write_coco(tmp_path / f"{camera}.json", images, 25)
    found = [(image.camera, image.t_s) for image in read_poses(tmp_path, fps=25)]
    assert sorted(found) == [(c, i / 25) for c in ("north", "south") for i in range(4)]
    assert [t_s for _, t_s in found] == sorted(t_s for _, t_s in found)


@pytest.mark.parametrize("image_id", ["{:06d}.jpg", "cam2/frame_{:d}.png", "img{:04d}", "7_{:d}_x"])
def test_the_number_may_stand_in_a_file_name(tmp_path, image_id):
    write_coco(tmp_path / "a.json", [made_poses("a", 12 / 25, 1)], 25, image_id.format)
    (image,) = read_poses(tmp_path / "a.json", fps=25)
    assert image.t_s == 12 / 25


def test_a_score_on_another_scale_gives_way_to_the_mean_of_the_points(tmp_path):
    entry = {"image_id": 1, "keypoints": [5, 5, 0.5] * 17, "score": 3.2}
    (tmp_path / "a.json").write_text(json.dumps([entry]))
    (image,) = read_poses(tmp_path / "a.json", fps=25)
    assert image.person_score.tolist() == [0.5]


@pytest.mark.parametrize("chunk", [1, 7, 1000])
def test_a_list_read_in_pieces_is_the_same(tmp_path, monkeypatch, chunk):
    images = [made_poses("a", i / 25, 2, i) for i in range(3)]
    write_coco(tmp_path / "a.json", images, 25)
    whole = list(read_poses(tmp_path / "a.json", fps=25))
    monkeypatch.setattr(coco, "CHUNK_CHARS", chunk)
    for found, expected in zip(read_poses(tmp_path / "a.json", fps=25), whole, strict=True):
        assert_same(found, expected)


def test_an_empty_list_has_no_images(tmp_path):
    (tmp_path / "a.json").write_text(" [ ] ")
    assert list(read_poses(tmp_path / "a.json", fps=25)) == []


ENTRY = '{"image_id": 1, "keypoints": [' + ",".join(["1"] * 51) + '], "score": 1}'


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "json list"),
        ('{"annotations": []}', "json list"),
        ("[" + ENTRY, "cut off"),
        ("[" + ENTRY + ', {"image_id": 1, "keyp', "cut off"),
        ("[" + ENTRY + ", 7]", "entry 1: expected image_id, keypoints and score"),
        ("[" + ENTRY + ", {}]", "entry 1: expected image_id, keypoints and score"),
        ('[{"image_id": -1, "keypoints": []}]', "image_id must be a number"),
        ('[{"image_id": "north", "keypoints": []}]', "image_id must be a number"),
        ('[{"image_id": true, "keypoints": []}]', "image_id must be a number"),
        ('[{"image_id": 1, "keypoints": [1]}]', "keypoints: expected x, y, score"),
        ("[" + ENTRY.replace("1,1,1", "NaN,1,1", 1) + "]", "NaN is not JSON"),
        (
            "[" + ENTRY.replace("_id", "_id_", 1).replace("score", "score", 1) + "]",
            "expected image",
        ),
        ("[" + ENTRY.replace(": 1,", ": 9,", 1) + "," + ENTRY + "]", "image 1 after image 9; sort"),
        ("[" * 100_000, "nested too deeply"),
        ('["' + "x" * 3_000_000, "cut off, or an entry is longer"),
        ("[" + "9" * 5000 + "]", "digits"),
        (b"[\xff\xfe]", "not UTF-8"),
    ],
)
def test_wrong_coco_results_are_told(tmp_path, content, message):
    path = tmp_path / "a.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError, match=r"a\.json") as caught:
        list(read_poses(path, fps=25))
    assert message in str(caught.value)
    assert len(str(caught.value)) < 600


def test_a_folder_of_jsonl_files_is_merged_by_time(tmp_path):
    for camera, start_s in (("a", 0.0), ("b", 0.01)):
        with PosesWriter(tmp_path / f"{camera}.poses.jsonl") as writer:
            for index in range(5):
                writer.write(made_poses(camera, start_s + index / 25, 1))
    found = [image.camera for image in read_poses(tmp_path)]
    assert found == ["a", "b"] * 5


def test_a_partial_file_is_read_like_a_whole_one(tmp_path):
    with PosesWriter(tmp_path / "a.poses.jsonl") as writer:
        writer.write(made_poses("a", 0.0, 1))
        assert len(list(read_poses(tmp_path / "a.poses.jsonl.partial"))) == 1


def test_a_rate_that_is_not_given_is_remarked(tmp_path, caplog):
    write_coco(tmp_path / "a.json", [made_poses("a", 1.0, 1)], 60)
    with caplog.at_level(logging.WARNING):
        (image,) = read_poses(tmp_path / "a.json")
    assert image.t_s == 2.0
    assert "30 frames per second" in caplog.text


def test_a_rate_is_not_asked_for_where_times_are_told(tmp_path, caplog):
    with PosesWriter(tmp_path / "a.poses.jsonl") as writer:
        writer.write(made_poses("a", 0.0, 1))
    list(read_poses(tmp_path / "a.poses.jsonl"))
    assert caplog.messages == []


@pytest.mark.parametrize("fps", [0.0, -25.0, float("nan"), float("inf")])
def test_an_impossible_rate_is_refused(tmp_path, fps):
    with pytest.raises(InputError, match="frame rate"):
        read_poses(tmp_path, fps=fps)


def test_cameras_that_the_rig_lacks_are_all_named_at_once(tmp_path):
    for camera in ("cam1", "cam2", "came3"):
        write_openpose(tmp_path / f"{camera}_json", made_poses("a", 0, 1), "a_0.json")
    with pytest.raises(InputError) as caught:
        read_poses(tmp_path, rig_cameras=["cam1", "cam3"], fps=25)
    assert "camera 'cam2' is not in the rig; known: cam1, cam3" in str(caught.value)
    assert "camera 'came3' is not in the rig; known: cam1, cam3; rename it" in str(caught.value)


def test_a_missing_path_is_told_at_once(tmp_path):
    with pytest.raises(InputError, match="no such file or folder"):
        read_poses(tmp_path / "none")


@pytest.mark.parametrize("files", [[], ["a.txt"], ["a.json"], ["sub/readme.md"]])
def test_a_folder_without_poses_tells_what_is_expected(tmp_path, files):
    for name in files:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("{}")
    with pytest.raises(InputError, match="no 2D poses in this folder"):
        read_poses(tmp_path)


def test_a_video_given_for_poses_tells_what_is_expected(tmp_path):
    (tmp_path / "a.mp4").write_bytes(bytes(range(256)) * 20)
    with pytest.raises(InputError, match=r"trecsim\.poses2d/1"):
        list(read_poses(tmp_path / "a.mp4"))
