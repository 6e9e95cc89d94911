import json
import logging
from collections import Counter

import numpy as np
import pytest

from sources.made_poses import (
    assert_same,
    instance,
    made_poses,
    mmpose_frames,
    write_coco,
    write_openpose,
)
from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.sources import json_stream, read_poses
from trecsim.sources.openpose import MAX_FILE_BYTES, camera_folders
from trecsim.store.poses_writer import PosesWriter
from trecsim.sync import frame_sets


def openpose_name(camera, frame):
    return f"{camera}_{frame:012d}_keypoints.json"


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
    assert list(camera_folders(tmp_path / "north_json", pytest.fail)) == ["north"]
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
        ('{"people": [{"pose_keypoints_2d": [Infinity]}]}', "Infinity is not JSON"),
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
    monkeypatch.setattr(json_stream, "CHUNK_CHARS", chunk)
    for found, expected in zip(read_poses(tmp_path / "a.json", fps=25), whole, strict=True):
        assert_same(found, expected)


NAMES = {
    "the camera's number after it": "{:06d}_cam1.jpg",
    "the size of the images after it": "hall_{:06d}_1080p.png",
    "numbers on both sides": "VID_2_{:d}_001_2.png",
    "a time in milliseconds after it": "frame_{:d}_at_{ms:d}.jpg",
    "a date before it": "2024-01-31_12-00_{:05d}.jpg",
}


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_of_several_numbers_in_names_the_one_that_counts_is_the_frame(tmp_path, name):
    images = [made_poses("cam1", i / 25, 1, i) for i in range(9, 13)]
    write_coco(tmp_path / "cam1.json", images, 25, lambda frame: name.format(frame, ms=40 * frame))
    found = read_poses(tmp_path / "cam1.json", fps=25)
    assert [image.t_s for image in found] == [image.t_s for image in images]


@pytest.mark.parametrize(
    "name", ["{:06d}_cam1_keypoints.json", "{:06d}_1080p.json", "cam1_{:06d}_keypoints.json"]
)
def test_the_frame_is_found_in_the_names_of_openpose_files_too(tmp_path, name):
    for frame in (9, 10, 11):
        write_openpose(tmp_path / "cam1_json", made_poses("a", 0, 1), name.format(frame))
    assert [image.t_s for image in read_poses(tmp_path, fps=10)] == [0.9, 1.0, 1.1]


def test_the_number_of_the_camera_is_not_the_frame_of_its_only_image(tmp_path):
    write_coco(tmp_path / "cam7.json", [made_poses("a", 12 / 25, 1)], 25, "{:d}_cam7.jpg".format)
    (image,) = read_poses(tmp_path / "cam7.json", fps=25)
    assert image.t_s == 12 / 25


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["a_1.jpg", "b_1.jpg"], "'a_1.jpg' and 'b_1.jpg' are both frame 1"),
        (["1_20.jpg", "2_21.jpg"], "cannot tell the frame number in names like '1_20' and '2_21'"),
        (["1_1.jpg", "1_2.jpg", "2_1.jpg"], "no number is another in each"),
    ],
)
def test_names_that_do_not_tell_the_frame_are_refused(tmp_path, names, message):
    entries = [{"image_id": name, "keypoints": [5, 5, 0.5] * 17} for name in names]
    (tmp_path / "a.json").write_text(json.dumps(entries))
    with pytest.raises(InputError, match=r"a\.json: ") as caught:
        list(read_poses(tmp_path / "a.json", fps=25))
    assert message in str(caught.value)


def test_an_image_without_people_is_one_in_which_only_other_cameras_have_entries(tmp_path):
    frames = {"a": (0, 1, 3), "b": (1, 2, 3), "c": (1, 2)}
    for camera, numbers in frames.items():
        write_coco(
            tmp_path / f"{camera}.json", [made_poses(camera, i / 25, 1) for i in numbers], 25
        )
    found = {camera: {} for camera in frames}
    for image in read_poses(tmp_path, fps=25):
        found[image.camera][round(25 * image.t_s)] = len(image.xy_px)
    # Before its first entry and after its last nothing is known of a camera.
    assert found == {"a": {0: 1, 1: 1, 2: 0, 3: 1}, "b": {1: 1, 2: 1, 3: 1}, "c": {1: 1, 2: 1}}


def test_the_first_camera_to_find_people_in_an_empty_room_is_not_said_to_be_ahead(tmp_path, caplog):
    for camera, resumes in (("a", 800), ("b", 790), ("c", 803)):
        frames = [*range(50), *range(resumes, resumes + 50)]
        images = [made_poses(camera, frame / 25, 1) for frame in frames]
        write_coco(tmp_path / f"{camera}.json", images, 25)
    times = Counter(image.t_s for image in read_poses(tmp_path, fps=25))
    assert {count for t_s, count in times.items() if t_s < 840 / 25} == {3}
    list(frame_sets(read_poses(tmp_path, fps=25)))
    assert caplog.messages == []


def test_a_camera_of_which_each_fifth_frame_was_looked_at_gets_no_images_between(tmp_path):
    write_coco(tmp_path / "a.json", [made_poses("a", i / 25, 1) for i in range(21)], 25)
    write_coco(tmp_path / "b.json", [made_poses("b", i / 25, 1) for i in (0, 10, 15, 20)], 25)
    images = [image for image in read_poses(tmp_path, fps=25) if image.camera == "b"]
    assert [(round(25 * image.t_s), len(image.xy_px)) for image in images] == [
        (0, 1), (5, 0), (10, 1), (15, 1), (20, 1),
    ]  # fmt: skip


META = {"dataset_name": "coco", "keypoint_id2name": dict(enumerate(COCO17.joints))}


@pytest.mark.parametrize("kind", ["inferencer", "demo", "demo with names"])
def test_mmposes_own_files_are_read_with_their_empty_images(tmp_path, kind):
    images = [made_poses("north", i / 25, i % 3, i) for i in range(7)]
    content = mmpose_frames(images)
    if kind != "inferencer":
        meta = META if kind == "demo with names" else {"dataset_name": "coco"}
        content = {"meta_info": meta, "instance_info": content}
    name = "north.json" if kind == "inferencer" else "results_north.json"
    (tmp_path / name).write_text(json.dumps(content))
    for path in (tmp_path, tmp_path / name):
        for found, expected in zip(read_poses(path, fps=25), images, strict=True):
            same_points(found, expected)
            np.testing.assert_array_equal(found.person_score, expected.person_score)


def test_mmposes_files_of_single_images_are_read_from_a_folder_for_each_camera(tmp_path):
    images = [made_poses("north", i / 25, 2, i) for i in range(1, 4)]
    (tmp_path / "north").mkdir()
    for image in images:
        people = [instance(image, person) for person in range(2)]
        (tmp_path / "north" / f"{round(25 * image.t_s):06d}.json").write_text(json.dumps(people))
    for path in (tmp_path, tmp_path / "north"):
        for found, expected in zip(read_poses(path, fps=25), images, strict=True):
            same_points(found, expected)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('[{"frame_id": 0}]', "entry 0: expected frame_id and instances"),
        ('[{"frame_id": -1, "instances": []}]', "entry 0: expected frame_id and instances"),
        ('[{"frame_id": 3, "instances": []}, {"frame_id": 3, "instances": []}]', "3 after 3"),
        ('[{"frame_id": 0, "instances": [7]}]', "instance 0: expected as many keypoint_scores"),
        (
            '[{"frame_id": 0, "instances": [{"keypoints": [[1, 2, 3]], "keypoint_scores": [1]}]}]',
            "expected key points [x, y] in pixels",
        ),
        (
            '[{"frame_id": 0, "instances": [{"keypoints": [[1, 2]], "keypoint_scores": [1]}]}]',
            "found 3 numbers, 1 key points",
        ),
        ('{"meta_info": {}}', "it lacks 'instance_info'"),
        ('{"meta_info": {"keypoint_id2name": {"0": "root"}}}', "its key points lack nose"),
        ('{"meta_info": {}, "instance_info": [', "damaged or cut off"),
        ('{"meta_info" 1', "damaged or cut off"),
    ],
)
def test_what_is_wrong_with_a_file_of_mmpose_is_told(tmp_path, content, message):
    (tmp_path / "a.json").write_text(content)
    with pytest.raises(InputError, match=r"a\.json: ") as caught:
        list(read_poses(tmp_path / "a.json", fps=25))
    assert message in str(caught.value)


def test_nan_is_missing_where_pose2sim_keeps_a_place_for_somebody_unseen(tmp_path):
    folder = tmp_path / "cam1_json"
    folder.mkdir()
    nobody = '{"pose_keypoints_2d": [' + ", ".join(["NaN"] * 78) + "]}"
    somebody = '{"pose_keypoints_2d": [' + ", ".join(["5, 6, 0.5"] * 25 + ["NaN, NaN, NaN"]) + "]}"
    (folder / "cam1_0.json").write_text('{"people": [' + nobody + ", " + somebody + "]}")
    (image,) = read_poses(tmp_path, fps=25)
    assert image.person_score.tolist() == [0.5]


PROJECT = ("pose-associated", "pose-sync", "pose")


@pytest.mark.parametrize("taken", PROJECT)
def test_of_a_pose2sim_project_the_last_step_is_taken_with_a_remark(tmp_path, taken, caplog):
    for number, name in enumerate(PROJECT[PROJECT.index(taken) :]):
        write_openpose(tmp_path / name / "cam1_json", made_poses("a", 0, 1), f"cam1_{number}.json")
    (image,) = read_poses(tmp_path, fps=10)
    assert image.t_s == 0.0
    told = [f"{taken} is read, as Pose2Sim does" in message for message in caplog.messages]
    assert told == ([] if taken == "pose" else [True])


def test_poses_of_an_earlier_step_that_are_given_are_taken_with_a_remark(tmp_path, caplog):
    for number, name in enumerate(PROJECT):
        write_openpose(tmp_path / name / "cam1_json", made_poses("a", 0, 1), f"cam1_{number}.json")
    (image,) = read_poses(tmp_path / "pose", fps=10)
    assert image.t_s == 0.2
    assert "Pose2Sim would read pose-associated beside it" in caplog.messages[0]


@pytest.mark.parametrize("kind", ["openpose", "mmpose"])
@pytest.mark.parametrize(("last", "remarked"), [(20, True), (38, False)])
def test_a_camera_whose_frames_end_early_is_remarked(tmp_path, kind, last, remarked, caplog):
    for camera, count in (("cam1", 41), ("cam2", last + 1), ("cam3", 40)):
        images = [made_poses(camera, i / 25, 1) for i in range(count)]
        if kind == "mmpose":
            (tmp_path / f"{camera}.json").write_text(json.dumps(mmpose_frames(images)))
        else:
            for i, image in enumerate(images):
                write_openpose(tmp_path / f"{camera}_json", image, f"{camera}_{i:06d}.json")
    assert len(list(read_poses(tmp_path, fps=25))) == 82 + last
    told = f"the frames of 'cam2' (to {last}) end before those of 'cam1' (to 40)"
    assert [told in message for message in caplog.messages] == [True] * remarked


def test_two_folders_of_one_camera_are_refused(tmp_path):
    for name in ("cam1", "cam1_json"):
        write_openpose(tmp_path / name, made_poses("a", 0, 1), "a_0.json")
    with pytest.raises(InputError, match="cam1 and cam1_json are both of the camera 'cam1'"):
        read_poses(tmp_path, fps=25)


def test_an_empty_list_has_no_images(tmp_path):
    (tmp_path / "a.json").write_text(" [ ] ")
    assert list(read_poses(tmp_path / "a.json", fps=25)) == []


ENTRY = '{"image_id": 1, "keypoints": [' + ",".join(["1"] * 51) + '], "score": 1}'


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "json list"),
        ('{"annotations": []}', "this is a COCO annotation file"),
        ('{"info": {"description": "COCO 2017"}, "images": []}', "this is a COCO annotation file"),
        ('{"people": []}', "json list"),
        ("[" + ENTRY, "cut off"),
        ("[" + ENTRY + ', {"image_id": 1, "keyp', "cut off"),
        ("[" + ENTRY + ", 7]", "entry 1: expected image_id, keypoints and score"),
        ("[" + ENTRY + ", {}]", "entry 1: expected image_id, keypoints and score"),
        ('[{"image_id": -1, "keypoints": []}]', "image_id must be a number"),
        ('[{"image_id": "north", "keypoints": []}]', "no frame number in the name 'north'"),
        ('[{"image_id": true, "keypoints": []}]', "image_id must be a number"),
        ('[{"image_id": 1, "keypoints": [1]}]', "keypoints: expected x, y, score"),
        ("[" + ENTRY.replace("1,1,1", "Infinity,1,1", 1) + "]", "Infinity is not JSON"),
        ("[" + "," * 5_000_000, "damaged or cut off"),
        ("[" + ENTRY + ",," + ENTRY + "]", "damaged or cut off"),
        ("[" + ENTRY + " " + ENTRY + "]", "damaged or cut off"),
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


@pytest.mark.parametrize("fps", [0.0, -25.0, float("nan"), float("inf"), 1e-300, 1e6])
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


def test_cameras_whose_name_stands_in_that_of_the_rig_are_taken_with_a_remark(tmp_path, caplog):
    for camera in ("cam01", "cam02"):
        write_openpose(tmp_path / f"{camera}_json", made_poses("a", 0, 1), "a_0.json")
    rig = ["int_cam01_img", "int_cam02_img", "cam3"]
    assert [one.camera for one in read_poses(tmp_path, rig_cameras=rig, fps=25)] == rig[:2]
    assert (
        "camera names differ from the rig: 'cam01' as 'int_cam01_img', 'cam02' as 'int_cam02_img'"
        in caplog.messages[0]
    )


def test_cameras_may_be_given_their_name_in_the_rig(tmp_path, caplog):
    for camera in ("cal_json1", "cal_json2", "north"):
        write_openpose(tmp_path / camera, made_poses("a", 0, 1), "a_0.json")
    names = {"cal_json1": "int_cam1_img", "cal_json2": "int_cam2_img"}
    rig = ["int_cam1_img", "int_cam2_img", "north"]
    found = read_poses(tmp_path, rig_cameras=rig, fps=25, names=names)
    assert [one.camera for one in found] == rig
    assert caplog.messages == []


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (
            {"cam3": "north"},
            "there is no camera 'cam3' to give another name; there are: cam1, cam2",
        ),
        ({"cam1": "west"}, "camera 'west' is not in the rig"),
        ({"cam1": "north", "cam2": "north"}, "two cameras would have one name: north, north"),
    ],
)
def test_names_that_do_not_fit_are_refused(tmp_path, names, told):
    for camera in ("cam1", "cam2"):
        write_openpose(tmp_path / camera, made_poses("a", 0, 1), "a_0.json")
    with pytest.raises(InputError) as caught:
        read_poses(tmp_path, rig_cameras=["north", "cam1", "cam2"], fps=25, names=names)
    assert told in str(caught.value)


def test_names_are_not_given_to_cameras_of_our_own_files(tmp_path):
    with PosesWriter(tmp_path / "a.poses.jsonl") as writer:
        writer.write(made_poses("a", 0.0, 1))
    for path in (tmp_path, tmp_path / "a.poses.jsonl"):
        with pytest.raises(InputError, match="name them as in the rig"):
            read_poses(path, names={"a": "b"})


@pytest.mark.parametrize("rig", [["cam1", "cam12"], ["a_cam_1", "b_cam1"]])
def test_a_camera_that_could_be_two_or_none_is_refused(tmp_path, rig):
    write_openpose(tmp_path / "cam_1_cam12_json", made_poses("a", 0, 1), "a_0.json")
    write_openpose(tmp_path / "cam1_json", made_poses("a", 0, 1), "a_0.json")
    with pytest.raises(InputError, match="is not in the rig"):
        read_poses(tmp_path, rig_cameras=rig, fps=25)


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
