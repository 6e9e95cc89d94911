import cv2
import numpy as np
import pytest

from trecsim.calibration.formats.opencv_yaml import format_opencv_yaml, parse_opencv_yaml


def test_what_opencv_writes_is_read(tmp_path):
    path = tmp_path / "made.yml"
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    big = np.random.default_rng(0).normal(size=(4, 4)) * 10.0 ** np.arange(-8, 8, 4)
    storage.write("big", big)
    storage.write("whole", np.arange(6, dtype=np.int32).reshape(2, 3))
    storage.write("number", 3)
    storage.write("real", -1.5e-7)
    storage.write("text", "north east")
    storage.startWriteStruct("inner", cv2.FileNode_MAP)
    storage.write("single", np.array([[0.5]]))
    storage.endWriteStruct()
    storage.startWriteStruct("names", cv2.FileNode_SEQ)
    storage.write("", "1")
    storage.write("", "left")
    storage.endWriteStruct()
    storage.release()
    data = parse_opencv_yaml(path.read_text())
    np.testing.assert_allclose(data["big"], big, rtol=1e-15)
    np.testing.assert_array_equal(data["whole"], np.arange(6).reshape(2, 3))
    np.testing.assert_array_equal(data["inner"]["single"], [[0.5]])
    assert (data["number"], data["real"], data["text"]) == (3, -1.5e-7, "north east")
    assert data["names"] == ["1", "left"]


def test_what_is_written_is_read_by_us_and_by_opencv(tmp_path):
    values = {"names": ["1", "a-b"], "T_1": np.array([[1e-9], [-2.5], [3.0]]), "W_1": 1920}
    text = format_opencv_yaml(values, ['made for a test: with [brackets] and "quotes"'])
    again = parse_opencv_yaml(text)
    np.testing.assert_array_equal(again["T_1"], values["T_1"])
    assert (again["names"], again["W_1"]) == (["1", "a-b"], 1920)
    path = tmp_path / "made.yml"
    path.write_text(text)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    np.testing.assert_array_equal(storage.getNode("T_1").mat(), values["T_1"])
    assert storage.getNode("names").at(1).string() == "a-b"
    storage.release()


def test_comments_and_both_ends_of_line_are_understood():
    text = '%YAML:1.0\r\n---\r\na: 1 # one\r\nb: [ 1, 2 ] # two\r\nc: "x # y"\r\n# d: 3\r\n'
    assert parse_opencv_yaml(text) == {"a": 1, "b": [1, 2], "c": "x # y"}


def test_only_numbers_are_numbers():
    text = "a: 012\nb: 1e5\nc: 12:30\nd: yes\ne: 1_000\nf: 0x10\ng: 2024-01-31\nh: ~\ni: '7'\n"
    assert parse_opencv_yaml(text) == {
        "a": 12, "b": 1e5, "c": "12:30", "d": "yes", "e": "1_000", "f": "0x10",
        "g": "2024-01-31", "h": "~", "i": "7",
    }  # fmt: skip


def test_special_numbers_are_numbers():
    data = parse_opencv_yaml("a: .Nan\nb: -.Inf\nc: 1.\nd: .5\n")
    assert np.isnan(data["a"])
    assert (data["b"], data["c"], data["d"]) == (-np.inf, 1.0, 0.5)


MATRIX = "a: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "empty"),
        ("%YAML:1.0\n---\n", "empty"),
        ("just words", "line 1 is not a name with a value"),
        ("[ 1, 2 ]", "line 1 is not a name with a value"),
        ("a: 1\na: 2", "line 2 gives 'a' a second time"),
        ("a: 1\n   b: 2", "line 2"),
        ("a:\n\tb: 2", "line 2"),
        ("a:", "line 1 has no value"),
        ("a: [ 1, 2", "line 1"),
        ("a: [ 1 ] 2", "line 1"),
        ("[ 1, 2 ]: 3", "line 1 is not a name"),
        ("a: !!python/object:os.system [ls]", "a tag trecsim cannot read: tag:yaml.org"),
        ("a: !!binary aGVsbG8=", "a tag trecsim cannot read"),
        ("a: &anchor 1", "has an anchor"),
        ("&a a: 1\n*a : 2", "line 2 is not a name"),
        ("a: 1\nb: *a", "has an anchor"),
        ("a: &a [ 1, 2 ]\nb: [ *a, *a ]", "has an anchor"),
        (MATRIX.format(3, 3, "[ 1., 2. ]"), "matrix of 3 x 3, but has 2 numbers"),
        (MATRIX.format(-1, -2, "[ 1., 2. ]"), "matrix of -1 x -2"),
        (MATRIX.format(1, 2, "[ 1., north ]"), "something else than numbers"),
        (MATRIX.format(1, 2, "7"), "without rows, cols or data"),
        (MATRIX.format("x", 2, "[ 1., 2. ]"), "without rows, cols or data"),
        ("a: !!opencv-matrix\nb: 1", "has no value"),
        ("a: " + "[" * 100_000, "nested too deeply"),
        ("a: " + "{b: " * 100_000, "nested too deeply"),
        ("\n".join(" " * i + "a:" for i in range(50)), "nested too deeply"),
    ],
)
def test_anything_else_is_refused_with_its_line(text, says):
    with pytest.raises(ValueError, match=says):
        parse_opencv_yaml(text)


@pytest.mark.parametrize("text", ["a" + " " * 10**6 + "b", "a: " + "1" * 10**6 + "x", "[" * 10**6])
def test_long_nonsense_takes_no_long_time(text):
    try:
        parse_opencv_yaml(text)
    except ValueError:
        return
