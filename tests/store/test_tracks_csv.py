"""The CSV file of tracks: its columns, and what is said about a wrong one."""

from pathlib import Path

import numpy as np
import pytest

from made_tracks import snapshot, walk
from trecsim.errors import InputError
from trecsim.skeleton import HALPE26
from trecsim.store import rows as rows_module
from trecsim.store.tracks import read_tracks
from trecsim.store.tracks_csv import CsvWriter, read_csv

HEADER = b"t_s,person,joint,x_m,y_m,z_m,sigma_m,support\n"
GOOD = b"0.5,1,nose,1.0,2.0,3.0,0.02,4\n"


def table(tmp_path: Path, content: bytes) -> Path:
    path = tmp_path / "tracks.csv"
    path.write_bytes(content)
    return path


def test_the_file_has_the_columns_of_the_contract(tmp_path: Path) -> None:
    with CsvWriter(tmp_path / "t.csv") as writer:
        writer.write(snapshot(1 / 3, [7], np.full((1, 17, 3), 0.1)))
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert lines[0] == "t_s,person,joint,x_m,y_m,z_m,sigma_m,support"
    assert lines[1] == "0.3333333333333333,7,nose,0.1,0.1,0.1,0.02,3"
    assert len(lines) == 18


def test_columns_may_come_in_any_order_quoted_and_with_dos_line_ends(tmp_path: Path) -> None:
    content = (
        b'\xef\xbb\xbf"support","sigma_m","x_m","y_m","z_m","joint","person","t_s"\r\n'
        b'4,0.02,1,2,3,"nose",1,0.5\r\n'
    )
    (read,) = read_csv(table(tmp_path, content))
    np.testing.assert_array_equal(read.xyz_m[0, 0], [1, 2, 3])
    assert (read.t_s, read.support[0, 0]) == (0.5, 4)


@pytest.mark.parametrize("missing", [b"nan", b"NaN", b"", b"NA"])
def test_an_unknown_joint_may_be_written_as_pandas_and_r_do(tmp_path: Path, missing: bytes) -> None:
    row = GOOD.replace(b"1.0,2.0,3.0,0.02", b",".join([missing] * 4))
    (read,) = read_csv(table(tmp_path, HEADER + row))
    assert np.isnan(read.xyz_m).all()


def test_people_and_joints_of_one_time_may_come_in_any_order(tmp_path: Path) -> None:
    rows = [GOOD.replace(b"nose", b"left_eye"), GOOD.replace(b",1,", b",0,"), GOOD]
    (read,) = read_csv(table(tmp_path, HEADER + b"".join(rows)))
    assert read.id.tolist() == [0, 1]
    assert np.isnan(read.xyz_m[0, 1]).all()
    assert np.isfinite(read.xyz_m[1, :2]).all()


FAULTS = {
    "text for a number": (
        b"0.5,1,nose,1.0,oops,3.0,0.02,4",
        "y_m: expected a number, found 'oops'",
    ),
    "a fraction for a person": (b"0.5,1.5,nose,1,2,3,0.02,4", "person: expected a whole number"),
    "a huge person": (b"0.5,99999999999999999999,nose,1,2,3,0.02,4", "person: .* is too large"),
    "a negative person": (b"0.5,-1,nose,1,2,3,0.02,4", "person must not be negative"),
    "an unknown joint": (b"0.5,1,left_knees,1,2,3,0.02,4", "did you mean 'left_knee'"),
    "too few values": (b"0.5,1,nose,1,2,3,0.02", "expected 8 values, found 7"),
    "an empty line": (b"", "expected 8 values, found 0"),
    "infinite": (b"0.5,1,nose,inf,2,3,0.02,4", "must be within 1e\\+06 m"),
    "half a position": (b"0.5,1,nose,nan,2,3,0.02,4", "must be all there or all NaN"),
    "negative sigma": (b"0.5,1,nose,1,2,3,-0.02,4", "sigma_m must be"),
    "negative support": (b"0.5,1,nose,1,2,3,0.02,-4", "support: expected a number of cameras"),
    "no time": (b",1,nose,1,2,3,0.02,4", "t_s: a value is missing"),
    "time is not a number": (b"nan,1,nose,1,2,3,0.02,4", "t_s: a value is missing"),
    "time backwards": (b"0.4,1,nose,1,2,3,0.02,4", "time runs backwards"),
    "twice the same": (GOOD.strip(), "were given before"),
    "not text": (b"0.5,1,\xff\xfe,1,2,3,0.02,4", "not UTF-8 text"),
}


@pytest.mark.parametrize(("row", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_a_fault_is_told_with_its_line(tmp_path: Path, row: bytes, message: str) -> None:
    path = table(tmp_path, HEADER + GOOD + row + b"\n" + GOOD.replace(b"0.5", b"9"))
    with pytest.raises(InputError, match=rf"tracks\.csv: .*line 3: .*{message}"):
        list(read_csv(path))


def test_several_faults_are_told_at_once_and_the_rest_counted(tmp_path: Path) -> None:
    bad = b"".join(b"x,1,nose,1,2,3,0.02,%d\n" % i for i in range(9))
    with pytest.raises(InputError, match=r"line 2: .*; line 3: .*and 4 more faults"):
        list(read_csv(table(tmp_path, HEADER + bad)))


def test_a_fault_far_into_a_long_file_has_the_right_line(tmp_path: Path) -> None:
    rows = b"".join(b"%d,%d,nose,1.0,2.0,3.0,0.02,4\n" % (i // 100, i % 100) for i in range(60_000))
    path = table(tmp_path, HEADER + rows + b"60000,1,nose,1.0,2.0,3.0,zzz,4\n")
    with pytest.raises(InputError, match="line 60002: sigma_m"):
        list(read_csv(path))


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (b"", "'t_s' is missing"),
        (b"t_s,person,joint,x_mm,y_m,z_m,sigma_m,support\n", "'x_mm'; did you mean 'x_m'"),
        (HEADER.replace(b"t_s,", b",t_s,"), "unknown column ''"),
        (b"\x00\xff\x89PNG\n", "line 1: expected the columns"),
    ],
)
def test_wrong_columns_are_named(tmp_path: Path, header: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        list(read_csv(table(tmp_path, header)))


def test_a_line_without_end_does_not_fill_the_memory(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a line is longer than"):
        list(read_csv(table(tmp_path, HEADER + b"1" * 5_000_000)))


def test_a_first_line_of_one_endless_word_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 1: expected the columns .*field limit"):
        list(read_csv(table(tmp_path, b"x" * 200_000)))


def test_a_moment_without_end_does_not_fill_the_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rows_module, "_MOST_ROWS_AT_ONE_TIME", 50_000)
    rows = b"".join(b"0,%d,nose,1,2,3,0,1\n" % i for i in range(110_000))
    with pytest.raises(InputError, match="more than a million"):
        list(read_csv(table(tmp_path, HEADER + rows)))


def test_an_error_keeps_what_was_written_under_another_name(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    with pytest.raises(KeyboardInterrupt):
        _write_and_stop(path)
    assert [p.name for p in tmp_path.iterdir()] == ["t.csv.partial"]
    assert len(list(read_csv(tmp_path / "t.csv.partial"))) == 5


def _write_and_stop(path: Path) -> None:
    with CsvWriter(path) as writer:
        for one in walk(5):
            writer.write(one)
        raise KeyboardInterrupt


@pytest.mark.parametrize(
    "content",
    [
        b't_s,person,"joint",x_m,y_m,z_m,sigma_m,support\n0.5,1,"left_heel",1.0,2.0,3.0,0.02,4\n',
        b"t_s,person,x_m,y_m,z_m,sigma_m,support,joint\r\n0.5,1,1.0,2.0,3.0,0.02,4,left_heel\r\n",
        b"joint,t_s,person,x_m,y_m,z_m,sigma_m,support\nleft_heel,0.5,1,1.0,2.0,3.0,0.02,4\n",
    ],
)
def test_feet_are_read_however_the_columns_are_written(tmp_path: Path, content: bytes) -> None:
    (read,) = read_tracks(table(tmp_path, content))
    np.testing.assert_array_equal(read.xyz_m[0, HALPE26.joints.index("left_heel")], [1, 2, 3])
