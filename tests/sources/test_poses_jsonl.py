import errno
import json
import logging
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sources.made_poses import assert_same, made_poses
from trecsim.errors import InputError, SetupError
from trecsim.sources import poses_jsonl, quick_json
from trecsim.sources.poses_jsonl import MAX_LINE_BYTES, read_poses_jsonl
from trecsim.store.poses_writer import PosesWriter
from trecsim.values import Poses2D

HEADER = '{"format": "trecsim.poses2d/1", "skeleton": "coco17"}\n'
PERSON = {"score": 0.9, "keypoints": [[1, 2.5, 0.5]] * 17}


def line(camera="north", t_s=0.0, people=(PERSON,), **more):
    return json.dumps({"camera": camera, "t_s": t_s, "people": list(people), **more}) + "\n"


@pytest.fixture
def read(tmp_path):
    def read(content, **kwargs):
        path = tmp_path / "room.poses.jsonl"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return list(read_poses_jsonl(path, **kwargs))

    return read


def refused(read, content, **kwargs):
    with pytest.raises(InputError) as caught:
        read(content, **kwargs)
    assert "room.poses.jsonl" in str(caught.value)
    return str(caught.value)


def test_what_is_written_is_read_again(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    images = [made_poses("ab"[i % 2], i / 8, i % 4, seed=i) for i in range(20)]
    with PosesWriter(path) as writer:
        for image in images:
            writer.write(image)
    for found, expected in zip(read_poses_jsonl(path), images, strict=True):
        assert_same(found, expected)


def test_the_file_is_as_the_contract_has_it(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    xy_px = np.full((1, 17, 2), np.nan)
    xy_px[0, 3] = 1.23456, -7.0
    score = np.zeros((1, 17))
    score[0, 3] = 0.98765
    with PosesWriter(path) as writer:
        writer.write(Poses2D("nörd", 12.345, xy_px, score, np.array([0.87])))
        writer.write(made_poses("south", 12.4, 0))
    header, first, second = path.read_text(encoding="utf-8").splitlines()
    assert json.loads(header) == {"format": "trecsim.poses2d/1", "skeleton": "coco17"}
    keypoints = [[1.23, -7.0, 0.988] if joint == 3 else None for joint in range(17)]
    assert json.loads(first) == {
        "camera": "nörd",
        "t_s": 12.345,
        "people": [{"score": 0.87, "keypoints": keypoints}],
    }
    assert json.loads(second) == {"camera": "south", "t_s": 12.4, "people": []}


def test_how_finely_people_were_looked_at_is_written_and_read(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    image = replace(made_poses("a", 1.0, 3), pixel_px=np.array([3.75, np.nan, 0.125]))
    with PosesWriter(path) as writer:
        writer.write(image)
    people = json.loads(path.read_text().splitlines()[1])["people"]
    assert [person.get("pixel_px") for person in people] == [3.75, None, 0.125]
    (found,) = read_poses_jsonl(path)
    np.testing.assert_array_equal(found.pixel_px, image.pixel_px)


@pytest.mark.parametrize("value", ["0", "-1", "1e9", "true", '"3"', "[]"])
def test_a_size_that_no_look_has_is_refused_with_its_line(read, value):
    person = {**PERSON, "pixel_px": "VALUE"}
    content = HEADER + line("b", 2, people=[person]).replace('"VALUE"', value)
    assert "line 2: person 0: 'pixel_px'" in refused(read, content)


def test_the_contract_s_own_example_is_read(read):
    joints = ["[1.5, 2, 0.5]", "null"] + ["[3, 4, 1.0]"] * 15
    (image,) = read(
        HEADER
        + '{"camera": "north", "t_s": 12.345, "people": [{"score": 0.87, "keypoints": ['
        + ", ".join(joints)
        + "]}]}\n"
    )
    assert (image.camera, image.t_s, image.person_score.tolist()) == ("north", 12.345, [0.87])
    assert image.xy_px[0, 0].tolist() == [1.5, 2.0]
    assert np.isnan(image.xy_px[0, 1]).all()
    assert image.score[0, :3].tolist() == [0.5, 0.0, 1.0]


def test_an_image_without_people_has_empty_arrays(read):
    (image,) = read(HEADER + line(people=[]))
    assert (image.xy_px.shape, image.score.shape) == ((0, 17, 2), (0, 17))
    assert image.person_score.shape == (0,)


def test_nulls_inside_a_key_point_are_missing_too(read):
    person = {"score": 1, "keypoints": [[None, None, 0.0]] * 16 + [[1, 2, 1]]}
    (image,) = read(HEADER + line(people=[person]))
    assert np.isnan(image.xy_px[0, :16]).all()
    assert image.xy_px[0, 16].tolist() == [1, 2]


def test_scores_a_little_outside_are_clipped(read):
    person = {"score": 1.2, "keypoints": [[1, 2, -0.05]] * 8 + [[1, 2, 1.05]] * 9}
    (image,) = read(HEADER + line(people=[person]))
    assert set(image.score[0].tolist()) == {0.0, 1.0}
    assert image.person_score.tolist() == [1.0]


def test_further_keys_blank_lines_and_a_byte_order_mark_do_no_harm(read):
    content = "\ufeff" + HEADER + line(t_s=1, exposure_s=0.01, lit=True) + "\r\n\n" + line(t_s=2)
    assert [image.t_s for image in read(content)] == [1.0, 2.0]


def test_the_last_line_may_end_without_a_newline(read, caplog):
    assert len(read(HEADER + line(t_s=1) + line(t_s=2).rstrip())) == 2
    assert caplog.messages == []


@pytest.mark.parametrize("tail", [b"", b"\0" * 700])
@pytest.mark.parametrize("length", [1, 10, 100, 300])
def test_a_line_cut_by_a_crash_is_left_out_with_a_warning(read, caplog, length, tail):
    content = (HEADER + line(t_s=1) + line(t_s=2)[:length]).encode() + tail
    with caplog.at_level(logging.WARNING):
        assert [image.t_s for image in read(content)] == [1.0]
    (message,) = caplog.messages
    assert "line 3" in message
    assert "cut off" in message


def test_a_line_damaged_in_the_middle_is_a_fault(read):
    assert "line 2: not valid JSON" in refused(read, HEADER + line()[:50] + "\n" + line(t_s=1))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "empty"),
        ("\n\n", "empty"),
        (line(), "expected the header"),
        ("[]\n", "expected the header"),
        ("{}\n", "expected the header"),
        ('{"format": "trecsim.poses2d/2", "skeleton": "coco17"}\n', "poses2d/2"),
        ('{"format": "trecsim.poses2d/1"}\n', "unknown skeleton None; known: coco17"),
        ('{"format": "trecsim.poses2d/1", "skeleton": "coco18"}\n', "unknown skeleton 'coco18'"),
        ('{"format": "trecsim.poses2d/1", "skeleton": ["coco17"]}\n', "unknown skeleton"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "not UTF-8"),
        ((HEADER + line()).encode("utf-16"), "not UTF-8"),
        ("x" * (MAX_LINE_BYTES + 10), "longer than"),
    ],
)
def test_a_wrong_header_tells_what_was_expected(read, content, message):
    text = refused(read, content)
    assert message in text
    assert "trecsim.poses2d/1" in text or "known: coco17" in text


def people(**changed):
    return [PERSON, {**PERSON, **changed}]


def joint(value):
    return [*PERSON["keypoints"][:4], value, *PERSON["keypoints"][5:]]


@pytest.mark.parametrize(
    ("faulty", "message"),
    [
        ("[1, 2]\n", "expected an object"),
        ('"north"\n', "expected an object"),
        ("{}\n", "lacks 'camera', 't_s', 'people'"),
        (line(camera=""), "'camera' must be a name"),
        (line(camera=7), "'camera' must be a name"),
        (line(t_s="1.0"), "'t_s' must be a number"),
        (line(t_s=None), "'t_s' must be a number"),
        (line(t_s=True), "'t_s' must be a number"),
        (line(t_s=1e300), "'t_s' must lie between"),
        ('{"camera": "north", "t_s": NaN, "people": []}\n', "NaN is not JSON"),
        ('{"camera": "north", "t_s": Infinity, "people": []}\n', "Infinity is not JSON"),
        ('{"camera": "north", "t_s": 1e999, "people": []}\n', "'t_s' must lie between"),
        ('{"camera": "north", "t_s": ' + "9" * 400 + ', "people": []}\n', "'t_s' must lie"),
        ('{"camera": "north", "t_s": ' + "9" * 5000 + ', "people": []}\n', "digits"),
        ('{"camera": "a", "camera": "b", "t_s": 1, "people": []}\n', "'camera' appears twice"),
        ('{"camera": "a", "t_s": 1, "people": ' + "[" * 100_000 + "\n", "nested too deeply"),
        (line(people=[]).replace("[]", '"none"'), "'people' must be a list"),
        (line(people=["somebody"]), "person 0 must be an object"),
        (line(people=people(keypoints=None)), "person 1: coco17 has 17 key points, found None"),
        (line(people=people(keypoints=[[1, 2, 1]] * 18)), "17 key points, found 18"),
        (line(people=people(keypoints=[])), "17 key points, found 0"),
        (line(people=people(keypoints="x" * 17)), "17 key points, found 'xxx"),
        (line(people=people(keypoints=joint([1, 2]))), "person 1, right_ear: expected [x, y, sc"),
        (line(people=people(keypoints=joint([]))), "person 1, right_ear: expected [x, y, score]"),
        (line(people=people(keypoints=joint(0))), "person 1, right_ear: expected [x, y, score]"),
        (line(people=people(keypoints=joint("abc"))), "person 1, right_ear: expected"),
        (line(people=people(keypoints=joint({"x": 1, "y": 2, "z": 3}))), "right_ear: expected"),
        (line(people=people(keypoints=joint(["1", 2, 1]))), "right_ear: x must be a number"),
        (line(people=people(keypoints=joint([1, True, 1]))), "right_ear: y must be a number"),
        (line(people=people(keypoints=joint([1, 2, None]))), "right_ear: score must be a number"),
        (line(people=people(keypoints=joint([1e9, 2, 1]))), "right_ear: x must lie between"),
        (line(people=people(keypoints=joint([1, 10**400, 1]))), "right_ear: y must lie between"),
        (line(people=people(keypoints=joint([1, 2, 87]))), "score must lie between -0.1 and 1.5"),
        (line(people=people(score=None)), "person 1: 'score' must be a number"),
        (line(people=people(score=-3)), "person 1: 'score' must lie between"),
        (line(people=[{"keypoints": PERSON["keypoints"]}]), "person 0: 'score' must be a number"),
        (line(note="x" * MAX_LINE_BYTES), "longer than"),
        (b'{"camera": "\xff\xfe", "t_s": 1, "people": []}\n', "not UTF-8"),
    ],
)
def test_a_wrong_line_is_named_with_what_is_wrong(read, faulty, message):
    faulty = faulty if isinstance(faulty, bytes) else faulty.encode()
    text = refused(read, (HEADER + line(t_s=-1.0)).encode() + faulty)
    assert "line 3" in text
    assert message in text
    assert len(text) < 400


def test_time_running_backwards_names_line_camera_and_both_times(read):
    content = HEADER + line("a", 5.0) + line("b", 1.0) + line("a", 5.5) + line("a", 5.25)
    text = refused(read, content)
    assert "line 5: camera 'a'" in text
    assert "5.25 s after 5.5 s" in text


def test_two_lines_for_one_image_are_refused(read):
    assert "line 3: camera 'a': a second image" in refused(read, HEADER + line("a") + line("a"))


def test_cameras_may_have_any_order_and_clock_between_them(read):
    content = HEADER + line("a", 5.0) + line("b", -1e6) + line("a", 5.1) + line("b", 7.0)
    assert len(read(content)) == 4


def test_an_unknown_camera_is_named_once_with_the_known_and_the_nearest(read):
    content = HEADER + "".join(line("nort", t_s) for t_s in range(5))
    text = refused(read, content, rig_cameras=["north", "south"])
    assert "line 2: camera 'nort' is not in the rig; known: north, south" in text
    assert "did you mean 'north'?" in text
    assert text.count("nort'") == 1


def test_cameras_of_the_rig_pass(read):
    assert len(read(HEADER + line("a") + line("b"), rig_cameras={"a", "b", "c"})) == 2


def test_faults_come_together_in_one_message_with_their_lines(read):
    good = [line("a", index) for index in range(10)]
    good[3], good[7] = line("a", "3"), "{\n"
    text = refused(read, HEADER + "".join(good))
    assert "line 5: 't_s'" in text
    assert "line 9: not valid JSON" in text


def test_ten_faults_are_enough(read):
    text = refused(read, HEADER + "{\n" * 500)
    assert "line 11:" in text
    assert "line 12:" not in text
    assert "there may be more" in text


def test_images_before_the_first_fault_are_given(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    path.write_text(HEADER + line(t_s=1) + line(t_s=2) + "{\n" + line(t_s=3))
    images = read_poses_jsonl(path)
    assert [next(images).t_s, next(images).t_s] == [1.0, 2.0]
    with pytest.raises(InputError, match="line 4"):
        next(images)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.poses\.jsonl"):
        next(read_poses_jsonl(tmp_path / "none.poses.jsonl"))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(data=st.data())
def test_no_damage_whatever_ends_in_anything_but_a_clear_error(read, data):
    content = bytearray((HEADER + line(t_s=1) + line("b", 2, people=[])).encode())
    for _ in range(data.draw(st.integers(0, 4))):
        place = data.draw(st.integers(0, len(content) - 1))
        patch = data.draw(st.binary(max_size=3) | st.sampled_from([b"1e999", b"null", b"[[", b"}"]))
        content[place : place + data.draw(st.integers(0, 5))] = patch
    try:
        images = read(bytes(content))
    except InputError as error:
        assert "room.poses.jsonl" in str(error)  # noqa: PT017
    else:
        for image in images:
            assert image.xy_px.shape[1:] == (17, 2)
            assert (image.score >= 0).all()
            assert (image.score <= 1).all()
            assert not np.isinf(image.xy_px).any()


def all_of(content):
    """Return all that the reader makes of a content, as text: every image, or the fault."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "room.poses.jsonl"
        path.write_bytes(content)
        try:
            return [repr([image.camera, image.t_s, image.xy_px.tolist(), image.score.tolist(),
                          image.person_score.tolist(), image.pixel_px.tolist()])
                    for image in read_poses_jsonl(path)]  # fmt: skip
        except InputError as error:
            return str(error).replace(folder, "")


@given(data=st.data())
def test_the_quick_reader_and_the_strict_one_make_the_same_of_every_line(data):
    ends = ["1e999", "null", "[[", "true", "1e-320", "9" * 30, "-0", '"t_s": 7,', "\\u0061", "0.1"]
    looked_at = {**PERSON, "pixel_px": 3.75}
    several = line("b", 2, people=[PERSON, looked_at])
    rest = bytearray((line(t_s=1) + several + line("b", 3.5)).encode())
    for _ in range(data.draw(st.integers(0, 3))):
        place = data.draw(st.integers(0, len(rest) - 1))
        patch = data.draw(st.sampled_from(ends) | st.text('0123456789.,[]{}e-"', max_size=3))
        rest[place : place + data.draw(st.integers(0, 5))] = patch.encode()
    content = HEADER.encode() + rest
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(quick_json, "decode", lambda line: None)
        patched.setattr(quick_json, "converted", lambda people, n_joints: None)
        strict = all_of(content)
    assert all_of(content) == strict


def test_well_formed_lines_are_read_without_the_strict_reader(read, monkeypatch):
    lines = [line("nörd", 1), line("b", 2, people=[]), line("b", 3, people=[PERSON] * 3)]
    monkeypatch.setattr(poses_jsonl._LineParser, "_carefully", None)
    assert [len(image.xy_px) for image in read(HEADER + "".join(lines))] == [1, 0, 3]


def test_while_writing_and_after_an_interrupt_the_part_is_readable(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    part = tmp_path / "room.poses.jsonl.partial"

    def interrupted():
        with PosesWriter(path) as writer:
            for index in range(3):
                writer.write(made_poses("a", float(index), 2))
                assert len(list(read_poses_jsonl(part))) == index + 1  # already on the disk
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not path.exists()
    assert [image.t_s for image in read_poses_jsonl(part)] == [0.0, 1.0, 2.0]


def test_an_interrupt_before_the_first_image_leaves_nothing(tmp_path):
    def interrupted():
        with PosesWriter(tmp_path / "room.poses.jsonl"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_success_leaves_one_file_and_replaces_the_old(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    path.write_text("old")
    with PosesWriter(path) as writer:
        writer.write(made_poses("a", 0.0, 1))
        assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
    assert len(list(read_poses_jsonl(path))) == 1


def test_a_place_that_cannot_be_written_to_is_named(tmp_path):
    for path in (tmp_path, tmp_path / "no" / "room.poses.jsonl"):
        with pytest.raises(InputError, match=str(path)), PosesWriter(path):
            pass
    assert list(tmp_path.iterdir()) == []


class FullDisk:
    """A file on a disk with room for three more lines."""

    def __init__(self, file):
        self._file, self._lines = file, 0

    def write(self, data):
        self._lines += 1
        if self._lines > 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        return self._file.write(data)

    def __getattr__(self, name):
        return getattr(self._file, name)


def test_a_full_disk_is_told_and_what_fitted_is_kept(tmp_path):
    path = tmp_path / "room.poses.jsonl"

    def fill():
        with PosesWriter(path) as writer:
            writer._file._file = FullDisk(writer._file._file)
            for index in range(9):
                writer.write(made_poses("a", float(index), 2))

    with pytest.raises(SetupError, match="full"):
        fill()
    assert not path.exists()
    assert len(list(read_poses_jsonl(tmp_path / "room.poses.jsonl.partial"))) == 3


def test_numbers_that_are_not_finite_are_written_as_missing(tmp_path):
    path = tmp_path / "room.poses.jsonl"
    xy_px = np.ones((1, 17, 2))
    xy_px[0, 0, 1], xy_px[0, 1, 0] = np.nan, np.inf
    score = np.full((1, 17), np.nan)
    with PosesWriter(path) as writer:
        writer.write(Poses2D("a", 0.0, xy_px, score, np.array([np.nan])))
    (image,) = read_poses_jsonl(path)
    assert np.isnan(image.xy_px[0, :2]).all()
    assert np.isfinite(image.xy_px[0, 2:]).all()
    assert image.person_score.tolist() == [0.0]
