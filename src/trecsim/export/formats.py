"""The formats that tracks are exported to, by the ending of the file name."""

from pathlib import Path

from trecsim.errors import InputError
from trecsim.export.base import Format

FORMATS = (
    Format(".csv", "CSV", "native_files:write_csv"),
    Format(".parquet", "Parquet", "native_files:write_parquet"),
    Format(".angles.csv", "joint angles as CSV", "angle_files:write_angles_csv"),
    Format(".mot", "joint angles (OpenSim)", "angle_files:write_mot", True, True),
    Format(".json", "JSON", "json_file:write_json"),
    Format(".trc", "TRC (OpenSim, Pose2Sim)", "trc_file:write_trc", True, True),
    Format(
        ".c3d", "C3D", "c3d_file:write_c3d", True, True, ("export", "ezc3d"), most_frames=65_535
    ),
    Format(".bvh", "BVH (Blender)", "bvh_file:write_bvh", True, True, holds_pose=True),
    Format(".glb", "glTF (Blender, three.js)", "glb_file:write_glb"),
    Format(".usda", "USD", "usd_file:write_usd"),
    Format(".usdc", "binary USD", "usd_file:write_binary_usd", needs=("usd", "pxr.Sdf")),
    Format(
        ".nc", "NetCDF (movement)", "movement_file:write_movement", False, True,
        ("movement", "movement.io.load_poses"),
    ),
    Format(".pedpy.txt", "text (PedPy)", "pedpy_file:write_pedpy", False, True),
    Format(".rrd", "recording (rerun)", "rerun_file:write_rerun", needs=("rerun", "rerun")),
)  # fmt: skip
NATIVE = (".csv", ".parquet")


def format_of(path: Path) -> Format:
    """Return the format that the ending of a file name chooses.

    Raises
    ------
    InputError
        When there is none; the message lists all.
    """
    name = path.name.lower()
    for one in sorted(FORMATS, key=lambda one: -len(one.ending)):
        if name.endswith(one.ending) and len(name) > len(one.ending):
            return one
    listed = ", ".join(f"{one.ending} {one.title}" for one in FORMATS)
    raise InputError(f"{path}: the ending chooses the format; there are {listed}")
