"""What is exported is read back by programs that are not ours, and compared in numbers."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from made_motion import RATE_HZ, exported, two_walkers
from trecsim.export.axes import MARKERS
from trecsim.skeleton import COCO17

TENTH_MM = 1e-4
Walkers = tuple[Path, np.ndarray, dict[int, np.ndarray]]


@pytest.fixture
def walkers(tmp_path: Path) -> Walkers:
    return two_walkers(tmp_path, "a walk.csv")


def trc_table(path: Path) -> tuple[list[str], np.ndarray]:
    """Read a TRC file as its tab-separated fields say."""
    lines = path.read_text().splitlines()
    rows = [[float(x) if x else np.nan for x in line.split("\t")] for line in lines[5:]]
    return lines[:5], np.array(rows)


def test_trc_holds_the_tracks_with_y_up_and_gaps_as_empty_fields(walkers: Walkers) -> None:
    tracks, t_s, people = walkers
    done = exported(tracks, tracks.with_suffix(".trc"))
    assert [file.name for file in done.files] == ["a walk_3.trc", "a walk_7.trc"]
    for file, truth in zip(done.files, people.values(), strict=True):
        head, rows = trc_table(file)
        assert head[0].split("\t")[3] == file.name
        assert head[2].split("\t") == ["25", "25", "100", "17", "m", "25", "1", "100"]
        assert head[3].split("\t")[2:-2:3] == MARKERS
        np.testing.assert_array_equal(rows[:, 0], np.arange(1, 101))
        np.testing.assert_allclose(rows[:, 1], t_s, atol=1e-6)
        found = rows[:, 2:].reshape(100, 17, 3)[..., [2, 0, 1]]
        np.testing.assert_allclose(found, truth, atol=TENTH_MM, equal_nan=True)


def test_opensim_reads_the_trc_file(walkers: Walkers) -> None:
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed")
    tracks, t_s, people = walkers
    file = exported(tracks, tracks.with_suffix(".trc")).files[0]
    table = opensim.TimeSeriesTableVec3(str(file))
    assert list(table.getColumnLabels()) == MARKERS
    np.testing.assert_allclose(np.array(table.getIndependentColumn()), t_s, atol=1e-6)
    for joint, marker in enumerate(MARKERS):
        column = table.getDependentColumn(marker)
        found = np.array([[column[row][axis] for axis in range(3)] for row in range(len(t_s))])
        truth = people[3][:, joint][:, [1, 2, 0]]
        np.testing.assert_allclose(found, truth, atol=TENTH_MM, equal_nan=True)


def test_c3d_holds_the_tracks_and_marks_what_is_missing(walkers: Walkers) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    tracks, _, people = walkers
    done = exported(tracks, tracks.with_suffix(".c3d"))
    for file, truth in zip(done.files, people.values(), strict=True):
        c3d = ezc3d.c3d(str(file))
        point = c3d["parameters"]["POINT"]
        assert point["LABELS"]["value"] == MARKERS
        assert point["UNITS"]["value"] == ["mm"]
        assert point["RATE"]["value"] == [RATE_HZ]
        found = c3d["data"]["points"][:3].transpose(2, 1, 0) / 1e3
        residuals = c3d["data"]["meta_points"]["residuals"][0].T
        missing = np.isnan(truth).any(axis=2)
        np.testing.assert_array_equal(residuals, np.where(missing, -1.0, 0.0))
        np.testing.assert_allclose(found[~missing], truth[~missing], atol=TENTH_MM)


def glb_nodes(path: Path) -> dict[str, dict[str, tuple[np.ndarray, np.ndarray]]]:
    """Return keys and values of each animated property of each node."""
    pygltflib = pytest.importorskip("pygltflib")
    gltf = pygltflib.GLTF2().load(str(path))
    blob = gltf.binary_blob()

    def values(index: int) -> np.ndarray:
        accessor = gltf.accessors[index]
        view = gltf.bufferViews[accessor.bufferView]
        width = {"SCALAR": 1, "VEC3": 3}[accessor.type]
        flat = np.frombuffer(blob, np.float32, accessor.count * width, view.byteOffset)
        return flat.reshape(accessor.count, width)

    found: dict[str, dict[str, tuple[np.ndarray, np.ndarray]]] = {}
    for channel in gltf.animations[0].channels:
        sampler = gltf.animations[0].samplers[channel.sampler]
        node = gltf.nodes[channel.target.node].name
        both = (values(sampler.input)[:, 0], values(sampler.output))
        found.setdefault(node, {})[channel.target.path] = both
    return found


def shown(keys: tuple[np.ndarray, np.ndarray] | None, t_s: np.ndarray) -> np.ndarray:
    """Return whether something is shown, from the keys of its scale, which hold."""
    if keys is None:
        return np.ones(len(t_s), bool)
    times, scale = keys
    return np.asarray(scale[np.searchsorted(times, t_s + 1e-4, side="right") - 1, 0] == 1.0)


def test_gltf_animates_each_joint_and_hides_who_is_absent(walkers: Walkers) -> None:
    tracks, t_s, people = walkers
    (file,) = exported(tracks, tracks.with_suffix(".glb")).files
    nodes = glb_nodes(file)
    for person, truth in people.items():
        there = np.isfinite(truth).all(axis=2)
        present = shown(nodes[f"person_{person}"].get("scale"), t_s)
        np.testing.assert_array_equal(present, there.any(axis=1))
        for joint, name in enumerate(COCO17.joints):
            node = nodes[f"person_{person}_{name}"]
            times, places = node["translation"]
            known = there[:, joint]
            np.testing.assert_array_equal(shown(node.get("scale"), t_s) & present, known)
            rows = np.searchsorted(times, t_s[known] - 1e-4)
            np.testing.assert_allclose(times[rows], t_s[known], atol=1e-6)
            back = places[rows][:, [0, 2, 1]] * [1.0, -1.0, 1.0]
            np.testing.assert_allclose(back, truth[known, joint], atol=TENTH_MM)


@pytest.mark.parametrize("ending", [".usda", ".usdc"])
def test_usd_holds_points_over_time_and_who_is_visible(ending: str, walkers: Walkers) -> None:
    pxr = pytest.importorskip("pxr.UsdGeom", reason="usd-core is not installed")
    from pxr import Usd

    tracks, t_s, people = walkers
    (file,) = exported(tracks, tracks.with_suffix(ending)).files
    assert not list(file.parent.glob(".*"))
    stage = Usd.Stage.Open(str(file))
    assert pxr.GetStageUpAxis(stage) == "Z"
    assert pxr.GetStageMetersPerUnit(stage) == 1.0
    for person, truth in people.items():
        points = pxr.Points(stage.GetPrimAtPath(f"/people/person_{person}"))
        for frame, time_s in enumerate(t_s):
            code = time_s * stage.GetTimeCodesPerSecond()
            present = points.GetVisibilityAttr().Get(code) == "inherited"
            known = np.isfinite(truth[frame]).all(axis=1)
            assert present == known.any()
            if present:
                at_m = np.array(points.GetPointsAttr().Get(code))
                np.testing.assert_allclose(at_m[known], truth[frame, known], atol=TENTH_MM)
                np.testing.assert_array_equal(np.array(points.GetWidthsAttr().Get(code)) > 0, known)


READ_BY_MOVEMENT = """
import sys
import numpy as np
try:
    from movement.io import load_poses
    import xarray
except ImportError:
    sys.exit(77)
from trecsim.export import export_tracks
export_tracks(sys.argv[1], sys.argv[2])
with xarray.open_dataset(sys.argv[2]) as data:
    axes = {name.rstrip("s"): name for name in data.position.dims}
    order = [axes["individual"], "time", axes["keypoint"], "space"]
    np.save(sys.argv[3], data.position.transpose(*order).values)
    print(data.attrs["fps"], *data.position[axes["individual"]].values)
"""


def test_movement_reads_its_data_set(walkers: Walkers, tmp_path: Path) -> None:
    # In a process of its own: here, a module of the benchmarks has the same name.
    tracks, _, people = walkers
    code, out, array = READ_BY_MOVEMENT, tmp_path / "o.nc", tmp_path / "o.npy"
    done = subprocess.run(
        [sys.executable, "-c", code, tracks, out, array], capture_output=True, text=True
    )
    if done.returncode == 77:
        pytest.skip("movement is not installed")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(RATE_HZ), "person_3", "person_7"]
    truth = np.array(list(people.values()))
    np.testing.assert_allclose(np.load(array), truth, atol=TENTH_MM, equal_nan=True)


def test_pedpy_reads_the_floor_points(walkers: Walkers) -> None:
    pedpy = pytest.importorskip("pedpy")
    tracks, _, people = walkers
    (file,) = exported(tracks, tracks.with_suffix(".pedpy.txt")).files
    data = pedpy.load_trajectory(trajectory_file=file)
    assert data.frame_rate == RATE_HZ
    for person, truth in people.items():
        one = data.data[data.data.id == person]
        there = np.isfinite(truth).any(axis=(1, 2))
        np.testing.assert_array_equal(one.frame, np.flatnonzero(there))
        floor_m = truth[there][:, 15:, :2].mean(axis=1)
        np.testing.assert_allclose(one[["x", "y"]], floor_m, atol=TENTH_MM)


def test_rerun_reads_one_batch_of_all_people_per_frame(walkers: Walkers) -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed")
    from rerun.chunk import RrdReader

    tracks, t_s, people = walkers
    (file,) = exported(tracks, tracks.with_suffix(".rrd")).files
    rows: list[tuple[float, list[list[float]]]] = []
    for chunk in RrdReader(file).stream():
        if chunk.entity_path == "/people/joints":
            table = chunk.to_record_batch()
            name = next(n for n in table.schema.names if n.endswith("Points3D:positions"))
            times = np.array(table["time"].cast("int64")) / 1e9
            rows += list(zip(times.tolist(), table[name].to_pylist(), strict=True))
    found = dict(rows)
    for frame, time_s in enumerate(t_s):
        truth = np.concatenate(
            [xyz_m[frame] for xyz_m in people.values() if np.isfinite(xyz_m[frame]).any()]
        )
        at_m = np.array(found[min(found, key=lambda t: abs(t - time_s))], float)
        np.testing.assert_allclose(at_m, truth, atol=TENTH_MM, equal_nan=True)


def test_json_holds_each_frame_with_its_people(walkers: Walkers) -> None:
    tracks, t_s, people = walkers
    (file,) = exported(tracks, tracks.with_suffix(".json")).files
    told = json.loads(file.read_text())
    assert told["joints"] == list(COCO17.joints)
    assert [frame["t_s"] for frame in told["frames"]] == t_s.tolist()
    for frame, entry in enumerate(told["frames"]):
        there = {who: xyz_m for who, xyz_m in people.items() if np.isfinite(xyz_m[frame]).any()}
        assert [one["person"] for one in entry["people"]] == list(there)
        for one in entry["people"]:
            at_m = np.array(one["xyz_m"], float)
            np.testing.assert_allclose(
                at_m, there[one["person"]][frame], atol=TENTH_MM, equal_nan=True
            )
            assert set(one["support"]) <= {0, 3}


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_one_person_alone_is_exported_in_our_own_formats_too(
    walkers: Walkers, ending: str, tmp_path: Path
) -> None:
    from trecsim.store.tracks import read_tracks

    tracks, t_s, people = walkers
    (file,) = exported(tracks, tmp_path / f"one{ending}", person=7).files
    found = list(read_tracks(file))
    there = np.isfinite(people[7]).any(axis=(1, 2))
    assert [one.t_s for one in found] == t_s[there].tolist()
    assert all(one.id.tolist() == [7] for one in found)
    xyz_m = np.array([one.xyz_m[0] for one in found])
    np.testing.assert_allclose(xyz_m, people[7][there], atol=1e-6)


def test_frames_of_a_long_c3d_file_go_on_in_the_next_part(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    from trecsim.export.exporting import _parts
    from trecsim.export.formats import format_of
    from trecsim.export.motions import Motion, PersonMotion

    frames = 70_000
    t_s = np.arange(frames) / RATE_HZ
    xyz_m = np.zeros((frames, 17, 3), np.float32)
    xyz_m[:, :, 0] = np.arange(frames)[:, None] / 1e3
    ones = np.ones((frames, 17), np.float32)
    person = PersonMotion(0, t_s, xyz_m, ones, ones.astype(np.uint16))
    motion = Motion((person,), 0.0, 1.0 / RATE_HZ, RATE_HZ)
    kind = format_of(tmp_path / "a.c3d")
    parts = list(_parts(motion, kind))
    assert [part.label for part in parts] == ["_0", "_0_part2"]
    from trecsim.export.base import About
    from trecsim.export.c3d_file import write_c3d

    last_x_m = -1e-3
    for part in parts:
        file = tmp_path / f"a{part.label}.c3d"
        write_c3d(part.motion, file, About(file.name, COCO17))
        c3d = ezc3d.c3d(str(file))
        x_m = c3d["data"]["points"][0, 0] / 1e3
        np.testing.assert_allclose(x_m, last_x_m + 1e-3 * np.arange(1, len(x_m) + 1), atol=TENTH_MM)
        last_x_m = x_m[-1]
        low, high = c3d["parameters"]["TRIAL"]["ACTUAL_START_FIELD"]["value"]
        assert (int(low) % 65536) + 65536 * int(high) == round(x_m[0] * 1e3) + 1
    assert round(last_x_m * 1e3) == frames - 1


def test_the_times_at_which_somebody_is_absent_are_the_recorded_ones(walkers: Walkers) -> None:
    tracks, _, _ = walkers
    (file,) = exported(tracks, tracks.with_suffix(".glb")).files
    keys, scale = glb_nodes(file)["person_7"]["scale"]
    np.testing.assert_allclose(keys, [0.0, 1.52, 2.52, 4.0], atol=1e-3)
    assert scale[:, 0].tolist() == [1.0, 0.0, 1.0, 0.0]
