"""Files of older formats are read as before, exported, and refused where they cannot go on."""

import shutil
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from made_live import assert_same_bits, live_moments
from older_tracks import FOLDER, older_moments
from trecsim.errors import InputError
from trecsim.store.compact_file import write_compact
from trecsim.store.erasing import keep_rows
from trecsim.store.parquet_file import read_file_info
from trecsim.store.parquet_reading import parts_of, read_parquet
from trecsim.store.precision import rounded
from trecsim.store.recorder import Recorder
from trecsim.store.rows import COLUMNS, COVARIANCE, VELOCITY
from trecsim.store.tracks import TracksInfo, export_tracks, read_tracks, tracks_writer

FULL = {f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "hip", "ankle")}
BOTH = pytest.mark.parametrize("version", [1, 2])


def older(version: int) -> Path:
    return FOLDER / f"tracks-{version}.parquet"


@BOTH
def test_an_older_file_is_read_with_all_that_it_holds(version: int) -> None:
    read = list(read_tracks(older(version), provisional=True))

    assert read_file_info(older(version)) == TracksInfo(
        rig_sha256="abc", format=f"trecsim.tracks/{version}"
    )
    assert len(read) == 3
    for one, made in zip(read, older_moments(), strict=True):
        assert one.t_s == made.t_s
        assert one.state.tolist() == made.state.tolist()
        np.testing.assert_array_equal(one.id, made.id)
        np.testing.assert_array_equal(one.support, made.support)
        np.testing.assert_allclose(one.xyz_m, made.xyz_m, rtol=1e-7)
        np.testing.assert_allclose(one.velocity_mps, made.velocity_mps, rtol=0)
        np.testing.assert_allclose(one.sigma_m, made.sigma_m, atol=0.5e-4)


def test_version_1_holds_the_covariance_of_every_joint() -> None:
    for one, made in zip(read_tracks(older(1), provisional=True), older_moments(), strict=True):
        np.testing.assert_allclose(one.cov_m2, made.cov_m2, rtol=1e-5)


def test_version_2_holds_the_covariances_of_six_joints_and_spheres_of_the_others() -> None:
    sphere_m2 = 0.0245**2 * np.eye(3)  # 600 mm^2 as a standard deviation in steps of 0.1 mm
    for one, made in zip(read_tracks(older(2), provisional=True), older_moments(), strict=True):
        joints = read_file_info(older(2)).skeleton.joints
        for number, name in enumerate(joints):
            expected = made.cov_m2[0, 0] if name in FULL else sphere_m2
            np.testing.assert_allclose(one.cov_m2[:, number], [expected] * 3, rtol=1e-12)


@BOTH
def test_an_older_file_is_exported_with_all_that_it_holds(version: int, tmp_path: Path) -> None:
    export_tracks(older(version), tmp_path / "new.parquet")
    export_tracks(older(version), tmp_path / "new.csv")

    before = list(read_tracks(older(version), provisional=True))
    for one, other in zip(
        read_tracks(tmp_path / "new.parquet", provisional=True), before, strict=True
    ):
        np.testing.assert_allclose(one.cov_m2, other.cov_m2, rtol=1e-4)
        np.testing.assert_allclose(one.xyz_m, other.xyz_m, rtol=1e-6)
        assert one.state.tolist() == other.state.tolist()
    assert [one.id.tolist() for one in read_tracks(tmp_path / "new.csv")] == [[4, 7]] * 3


@BOTH
def test_rows_of_an_older_file_are_deleted_and_its_format_stays(
    version: int, tmp_path: Path
) -> None:
    path = shutil.copy(older(version), tmp_path / "tracks.parquet")
    gone = keep_rows(path, lambda table: table["person"].to_numpy() != 7)

    assert gone == 3 * 17
    assert read_file_info(path).format == f"trecsim.tracks/{version}"
    before = [one.of(one.id != 7) for one in read_parquet(older(version))]
    assert_same_bits(list(read_parquet(path)), before)


@BOTH
@pytest.mark.parametrize("open_again", [tracks_writer, Recorder])
def test_a_recording_of_an_older_format_is_not_continued(
    version: int, open_again: type[Recorder], tmp_path: Path
) -> None:
    path = tmp_path / "tracks.parquet"
    parts_of(path).mkdir()
    shutil.copy(older(version), parts_of(path) / "00000001.parquet")

    with pytest.raises(InputError, match=f"format trecsim.tracks/{version}, which can be read"):
        open_again(path, TracksInfo(), resume=True)
    assert len(list(read_parquet(path))) == 3


def test_moments_of_version_2_get_the_present_format_without_a_change_but_to_covariances(
    tmp_path: Path,
) -> None:
    read = list(read_parquet(older(2)))
    with tracks_writer(tmp_path / "new.parquet") as writer:
        for one in read:
            writer.write(one)
    assert_same_bits(list(read_parquet(tmp_path / "new.parquet")), [rounded(one) for one in read])
    for one, other in zip(read, map(rounded, read), strict=True):
        np.testing.assert_array_equal(one.xyz_m, other.xyz_m)
        np.testing.assert_array_equal(one.velocity_mps, other.velocity_mps)
        np.testing.assert_allclose(one.sigma_m, other.sigma_m, rtol=0.01)


def test_the_columns_are_the_same_in_every_format(tmp_path: Path) -> None:
    with tracks_writer(tmp_path / "tracks.parquet") as writer:
        for one in older_moments():
            writer.write(one)
    names = [*COLUMNS, "state", *VELOCITY, *COVARIANCE]
    for path in (older(1), older(2), tmp_path / "tracks.parquet"):
        assert pq.read_schema(path).names == names


def test_tables_of_two_formats_do_not_become_one_file(tmp_path: Path) -> None:
    from trecsim.skeleton import COCO17
    from trecsim.store.compact import compact_table

    new = compact_table(list(live_moments(3)), COCO17)
    with pytest.raises(ValueError, match="schema"):
        write_compact(tmp_path / "t.parquet", [pq.read_table(older(2)), new], TracksInfo())
    assert not (tmp_path / "t.parquet").exists()
