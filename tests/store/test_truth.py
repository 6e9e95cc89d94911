"""The truth file: what goes in comes out, and what is said about a wrong one."""

import contextlib
import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.store.truth import read_truth, write_truth

T_S = np.array([0.0, 0.1, 0.2])


def standing(people: int = 2, joints: int = 17) -> np.ndarray:
    return np.ones((people, len(T_S), joints, 3))


def file_of(folder: Path, **arrays: Any) -> Path:
    path = folder / "truth.npz"
    np.savez_compressed(path, **{"t_s": T_S, "xyz_m": standing(), **arrays})
    return path


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_truth(path)
    text = str(caught.value)
    assert text.count("\n") == 0
    assert path.name in text
    return text


def test_what_was_written_is_read_from_the_file_and_its_directory(tmp_path: Path) -> None:
    xyz_m = standing()
    xyz_m[1, 0] = np.nan
    write_truth(tmp_path / "truth.npz", T_S, xyz_m)
    for path in (tmp_path / "truth.npz", tmp_path):
        truth = read_truth(path)
        np.testing.assert_array_equal(truth.t_s, T_S)
        np.testing.assert_array_equal(truth.xyz_m, xyz_m)


def test_a_truth_without_anybody_is_a_truth(tmp_path: Path) -> None:
    assert read_truth(file_of(tmp_path, xyz_m=standing(0))).xyz_m.shape == (0, 3, 17, 3)


def test_other_real_numbers_become_float64(tmp_path: Path) -> None:
    truth = read_truth(file_of(tmp_path, t_s=np.arange(3), xyz_m=standing().astype(np.float32)))
    assert (truth.t_s.dtype, truth.xyz_m.dtype) == (np.float64, np.float64)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    assert "No such file" in refused(tmp_path / "truth.npz")


@pytest.mark.parametrize("content", [b"", b"t_s,person\n", b"PK\x03\x04" + bytes(40)])
def test_a_file_of_something_else_is_told(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "truth.npz").write_bytes(content)
    assert "not a readable truth file" in refused(tmp_path / "truth.npz")


def test_every_cut_through_a_file_is_told(tmp_path: Path) -> None:
    whole = file_of(tmp_path).read_bytes()
    for end in range(0, len(whole), 37):
        (tmp_path / "cut.npz").write_bytes(whole[:end])
        assert "not a readable truth file" in refused(tmp_path / "cut.npz")


def test_damaged_bytes_are_told_or_do_no_harm(tmp_path: Path) -> None:
    whole = file_of(tmp_path).read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(200):
        damaged = bytearray(whole)
        damaged[rng.integers(len(whole))] = rng.integers(256)
        (tmp_path / "damaged.npz").write_bytes(damaged)
        with contextlib.suppress(InputError):
            assert read_truth(tmp_path / "damaged.npz").t_s.shape == T_S.shape


@pytest.mark.parametrize(
    ("arrays", "told"),
    [
        ({"xyz_m": standing(joints=26)}, "expected the 17 joints of coco17, found 26"),
        ({"xyz_m": standing()[..., :2]}, r"found (2, 3, 17, 2)"),
        ({"xyz_m": standing()[0]}, r"found (3, 17, 3)"),
        ({"xyz_m": standing()[:, :2]}, "t_s has 3 times and xyz_m 2"),
        ({"t_s": T_S[:, None]}, "one axis"),
        ({"t_s": np.empty(0), "xyz_m": standing()[:, :0]}, "the truth is empty"),
        ({"t_s": np.array([0, np.nan, 1])}, "t_s[1] is nan"),
        ({"t_s": np.array([0, 1, np.inf])}, "t_s[2] is inf"),
        ({"t_s": np.array([0.0, 0.2, 0.1])}, "t_s[2] = 0.1 s runs back from t_s[1] = 0.2 s"),
        ({"t_s": np.array([0.0, 0.1, 0.1])}, "t_s[2] = 0.1 s repeats"),
        ({"t_s": np.array(["a", "b", "c"])}, "t_s: expected real numbers"),
        ({"xyz_m": standing() * 1j}, "xyz_m: expected real numbers, found the type complex128"),
        ({"xyz_m": standing().astype(object)}, "found the type object"),
    ],
)
def test_arrays_that_cannot_be_are_told(tmp_path: Path, arrays: dict[str, Any], told: str) -> None:
    assert told in refused(file_of(tmp_path, **arrays))


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (np.inf, "xyz_m[1, 2, 9] (left_wrist) is infinite"),
        (-1e9, "xyz_m[1, 2, 9] (left_wrist) is farther than 1000 km"),
        (np.nan, "xyz_m[1, 2, 9] (left_wrist) must be all there or all NaN"),
    ],
)
def test_a_joint_that_cannot_be_is_named(tmp_path: Path, value: float, told: str) -> None:
    xyz_m = standing()
    xyz_m[1, 2, 9, 1] = value
    assert told in refused(file_of(tmp_path, xyz_m=xyz_m))


def test_a_missing_array_is_told_with_what_is_there(tmp_path: Path) -> None:
    np.savez(tmp_path / "truth.npz", t_s=T_S, joints_world_m=standing())
    assert "missing: xyz_m; found: t_s, joints_world_m" in refused(tmp_path / "truth.npz")


def test_an_array_under_another_name_in_the_archive_is_told(tmp_path: Path) -> None:
    file_of(tmp_path)
    with zipfile.ZipFile(tmp_path / "truth.npz") as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(tmp_path / "bare.npz", "w") as archive:
        for name, data in parts.items():
            archive.writestr(name.removesuffix(".npy"), data)
    assert "missing: t_s, xyz_m" in refused(tmp_path / "bare.npz")


def test_an_array_that_claims_to_be_huge_is_not_read(tmp_path: Path) -> None:
    header = io.BytesIO()
    claim = {"descr": "<f8", "fortran_order": False, "shape": (4, 10**12, 17, 3)}
    np.lib.format.write_array_header_1_0(header, claim)
    t_s = io.BytesIO()
    np.lib.format.write_array(t_s, T_S)
    with zipfile.ZipFile(tmp_path / "truth.npz", "w") as archive:
        archive.writestr("t_s.npy", t_s.getvalue())
        archive.writestr("xyz_m.npy", header.getvalue())
    assert "cut the recording" in refused(tmp_path / "truth.npz")


def test_a_file_that_unpacks_to_a_thousand_times_its_size_is_not_read(tmp_path: Path) -> None:
    t_s, xyz_m = np.arange(200_000.0), np.zeros((1, 200_000, 17, 3))
    np.savez_compressed(tmp_path / "truth.npz", t_s=t_s, xyz_m=xyz_m)
    assert (tmp_path / "truth.npz").stat().st_size < 700_000
    assert "almost all of them are the same" in refused(tmp_path / "truth.npz")


def test_people_who_are_seldom_there_are_no_fault(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    t_s, xyz_m = np.arange(20_000.0), np.full((10, 20_000, 17, 3), np.nan)
    xyz_m[:, :100] = rng.normal(size=(10, 100, 17, 3))
    np.savez_compressed(tmp_path / "truth.npz", t_s=t_s, xyz_m=xyz_m)
    np.testing.assert_array_equal(read_truth(tmp_path / "truth.npz").xyz_m, xyz_m)


def test_a_time_beyond_all_calendars_is_told(tmp_path: Path) -> None:
    assert "t_s[2] is 1e+300" in refused(file_of(tmp_path, t_s=np.array([0.0, 1.0, 1e300])))


def test_a_fault_late_in_a_long_truth_is_named(tmp_path: Path) -> None:
    xyz_m = np.random.default_rng(1).normal(size=(1, 25_000, 17, 3))
    xyz_m[0, 20_001, 3, 1] = 1e7
    told = refused(file_of(tmp_path, t_s=np.arange(25_000.0), xyz_m=xyz_m))
    assert "xyz_m[0, 20001, 3] (left_ear) is farther than 1000 km" in told
