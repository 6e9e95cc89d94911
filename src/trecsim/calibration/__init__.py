"""Rigs in files: read in many formats, written in some, always metres and z up inside.

The user may say what a file does not (its unit, the floor, the size of the images). What is
doubtful without being wrong is a remark of one line: it is logged, unless the caller hands in a
function that takes it, as the commands do.
"""

from collections.abc import Callable
from pathlib import Path

from trecsim.calibration.floor import Floor
from trecsim.calibration.formats.known import FORMATS, Format, format_called, open_rig
from trecsim.calibration.formats.read_options import ReadOptions, logger
from trecsim.calibration.formats.single_camera import cameras_in
from trecsim.calibration.formats.trecsim_toml import write_intrinsics
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

__all__ = [
    "FORMATS",
    "Floor",
    "Format",
    "format_to_write",
    "read_intrinsics",
    "read_rig",
    "write_intrinsics",
    "write_rig",
]


def read_rig(
    path: Path,
    *,
    format: str | None = None,
    unit_m: float | None = None,
    floor: Floor | None = None,
    size_px: tuple[int, int] | None = None,
    remark: Callable[[str], None] = logger.warning,
) -> Rig:
    """Read a rig from a file, or from the only one in a directory.

    Parameters
    ----------
    path
        The file or directory; a trecsim rig file or any format in `FORMATS`.
    format
        Name of the format; None recognises it by the content.
    unit_m
        Length of the file's unit [m]; None takes what the format says, or guesses and remarks.
    floor
        The way from the file's frame to the floor; None keeps the frame, and remarks if it
        cannot be the room's.
    size_px
        Image (width, height) of all cameras [px], for a format that does not tell it.
    remark
        Is called with each remark; the default logs it.

    Raises
    ------
    CalibrationError
        There is no such rig, or something in it is wrong: every fault in one message.
    """
    found, document = open_rig(Path(path), format)
    return found.read(document, ReadOptions(unit_m, floor, size_px, remark))


def read_intrinsics(path: Path) -> Rig:
    """Read what a rig file says about the cameras themselves; poses may be missing.

    Parameters
    ----------
    path
        The file or directory: a trecsim rig file, with ``T_cam_world`` or without, or any other
        format in `FORMATS`; of files of one camera each, a directory.

    Returns
    -------
    The cameras. Where the file has no pose, `Camera.T_cam_world` is the identity.

    Raises
    ------
    CalibrationError
        There is no such file, or something in it is wrong: every fault in one message.
    """
    path = Path(path)
    quiet = ReadOptions(remark=lambda _: None, intrinsics_only=True)
    if path.is_dir() and (cameras := cameras_in(path, quiet)):
        return Rig(tuple(cameras))
    found, document = open_rig(path, None)
    return found.read(document, quiet)


def write_rig(
    rig: Rig,
    path: Path,
    *,
    format: str | None = None,
    unit_m: float = 1.0,
    remark: Callable[[str], None] = logger.warning,
) -> None:
    """Write a rig to a file (EasyMocap: into a directory), whole or not at all.

    Parameters
    ----------
    rig
        The rig.
    path
        Where to.
    format
        Name of the format; None takes it from the name of the file: ``Calib*.toml`` is
        Pose2Sim's, other ``.toml`` trecsim's own, ``.yml`` MC-Calib's, no suffix EasyMocap's.
    unit_m
        Length of the file's unit [m]; trecsim's own is always in metres.
    remark
        Is called with what the format cannot hold; the default logs it.

    Raises
    ------
    CalibrationError
        The format cannot hold the rig.
    """
    path = Path(path)
    chosen = format_to_write(path, format)
    ReadOptions(unit_m)  # refuses what cannot be a unit
    if chosen.write is not None:
        for text in chosen.write(rig, path, unit_m):
            remark(text)


def format_to_write(path: Path, name: str | None = None) -> Format:
    """Return the format in which a rig would be written to a path.

    Parameters
    ----------
    path
        Where to.
    name
        Name of the format; None takes it from the name of the file.

    Raises
    ------
    CalibrationError
        There is no such format, or it is only read.
    """
    chosen = format_called(name or _format_of_name(path))
    if chosen.write is None:
        writable = ", ".join(entry.name for entry in FORMATS if entry.write)
        raise CalibrationError(
            f"trecsim reads {chosen.about}, but does not write it; it writes: {writable}"
        )
    return chosen


def _format_of_name(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix == ".toml":
        return "pose2sim" if path.name.lower().startswith("calib") else "trecsim"
    if suffix in (".yml", ".yaml"):
        return "mc-calib"
    if suffix == "":
        return "easymocap"
    raise CalibrationError(
        f"cannot tell from the name {path.name!r} in which format to write the rig; give it a "
        "name that ends in .toml (trecsim) or .yml (MC-Calib), or name the format"
    )
