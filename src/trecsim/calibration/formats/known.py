"""The rig formats trecsim knows, recognised by the content of a file and not by its name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trecsim.calibration.formats import (
    camera_json,
    camera_toml,
    easymocap,
    mc_calib,
    number_lines,
    opencap,
    pose_tables,
    qualisys,
    single_camera,
    trecsim_toml,
    vicon,
)
from trecsim.calibration.formats.document import Document, Syntax, read_document
from trecsim.calibration.formats.fields import nearest
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

SUFFIXES = (".toml", ".yml", ".yaml", ".json", ".txt", ".xml", ".xcp")
MOST_FILES = 200  # of these suffixes in a directory, for one to be looked for


@dataclass(frozen=True, slots=True)
class Format:
    """One format of a rig.

    Attributes
    ----------
    name
        Its name in trecsim.
    about
        What it is, for messages.
    syntax
        The syntax of its files.
    recognise
        Returns whether the content of a file has this format.
    read
        Returns the rig of such a file, or raises CalibrationError with every fault, each with the
        camera it belongs to.
    write
        Writes a rig to a file or directory with lengths in a unit [m], and returns remarks on what
        the format cannot hold; None if the format is only read.
    """

    name: str
    about: str
    syntax: Syntax
    recognise: Callable[[Mapping[str, Any]], bool]
    read: Callable[[Document, ReadOptions], Rig]
    write: Callable[[Rig, Path, float], list[str]] | None = None


FORMATS = (
    Format(
        "trecsim",
        "trecsim's rig.toml",
        "toml",
        trecsim_toml.recognise,
        trecsim_toml.read,
        trecsim_toml.write,
    ),
    Format(
        "mc-calib",
        "MC-Calib's calibrated_cameras_data.yml",
        "yaml",
        mc_calib.recognise,
        mc_calib.read,
        mc_calib.write,
    ),
    Format(
        "pose2sim",
        "Pose2Sim's Calib*.toml",
        "toml",
        camera_toml.is_pose2sim,
        camera_toml.read_pose2sim,
        camera_toml.write_pose2sim,
    ),
    Format(
        "anipose",
        "the toml of aniposelib, FreeMoCap or caliscope",
        "toml",
        camera_toml.is_anipose,
        camera_toml.read_anipose,
        camera_toml.write_anipose,
    ),
    Format(
        "easymocap",
        "EasyMocap's intri.yml and extri.yml in one directory",
        "yaml",
        easymocap.recognise,
        easymocap.read,
        easymocap.write,
    ),
    Format("qualisys", "Qualisys' .qca.txt", "xml", qualisys.recognise, qualisys.read),
    Format("vicon", "Vicon's .xcp", "xml", vicon.recognise, vicon.read),
    Format(
        "krtd",
        "KRTD files of KWIVER or MEVA, one camera each",
        "numbers",
        number_lines.are_krtd,
        number_lines.read_krtd,
    ),
    Format(
        "biocv",
        "BioCV's .calib files, one camera each",
        "numbers",
        number_lines.are_biocv,
        number_lines.read_biocv,
    ),
    Format(
        "opencap",
        "OpenCap's pickles, one in the folder of each camera",
        "pickle",
        opencap.recognise,
        opencap.read,
    ),
    Format(
        "panoptic",
        "CMU Panoptic's json",
        "json",
        camera_json.is_panoptic,
        camera_json.read_panoptic,
    ),
    Format(
        "json",
        "a json table of cameras with K, R, t, dist, width, height",
        "json",
        camera_json.is_table,
        camera_json.read_table,
    ),
    Format(
        "4d-association",
        "4D Association's json with K and RT of each camera",
        "json",
        pose_tables.is_association,
        pose_tables.read_association,
    ),
    Format(
        "voxelpose",
        "VoxelPose's json of Shelf or Campus",
        "json",
        pose_tables.is_position_table,
        pose_tables.read_position_table,
    ),
    Format(
        "opencv",
        "the yaml of one camera as OpenCV and ROS write it (intrinsics only)",
        "yaml",
        single_camera.recognise,
        single_camera.read,
    ),
)


def format_called(name: str) -> Format:
    """Return the format called `name`.

    Raises
    ------
    CalibrationError
        There is none; the message has the known ones.
    """
    known = {entry.name: entry for entry in FORMATS}
    if name not in known:
        near = nearest(name, known)
        meant = f"did you mean {near!r}?" if near else f"known: {', '.join(known)}"
        raise CalibrationError(f"there is no rig format called {name!r}; {meant}")
    return known[name]


def recognise(document: Document) -> Format | None:
    """Return the format of a file, by its content; None if it is no rig."""
    return next(
        (
            entry
            for entry in FORMATS
            if entry.syntax == document.syntax and entry.recognise(document.data)
        ),
        None,
    )


def open_rig(path: Path, name: str | None) -> tuple[Format, Document]:
    """Return the calibration at `path`, a file or a directory with one, and its format.

    Raises
    ------
    CalibrationError
        There is none, or there are several; the message says what was tried.
    """
    if _is_directory(path):
        several = number_lines.cameras_in(path) or opencap.cameras_in(path)
        if several is None:
            return _search(path, name)
        document = several
    else:
        document = read_document(path)
    if name is not None:
        wanted = format_called(name)
        if not (wanted.syntax == document.syntax and wanted.recognise(document.data)):
            raise CalibrationError(f"{path} is not {wanted.about}; leave the format out to find it")
        return wanted, document
    found = recognise(document)
    if found is None:
        known = "\n  ".join(f"{entry.name}: {entry.about}" for entry in FORMATS)
        raise CalibrationError(
            f"{path} is no rig that trecsim can read (as {document.syntax.upper()} it has "
            f"{_names(document.data)}); it reads:\n  {known}"
        )
    return found, document


def _is_directory(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # no right to look: reading it as a file says so
        return False


def _names(data: Mapping[str, Any]) -> str:
    names = [repr(key)[:30] for key in list(data)[:5]]
    return (", ".join(names) + (", ..." if len(data) > 5 else "")) or "nothing in it"


def _search(folder: Path, name: str | None) -> tuple[Format, Document]:
    try:
        files = sorted(
            file for file in folder.iterdir() if file.suffix.lower() in SUFFIXES and file.is_file()
        )
    except OSError as error:
        raise CalibrationError(f"cannot look into {folder}: {error.strerror}") from None
    if len(files) > MOST_FILES:
        raise CalibrationError(
            f"{folder} has {len(files)} files that could be a rig; give the file itself"
        )
    found, reasons = _rigs_among(files, name)
    if len(found) == 1:
        return found[0]
    if found:
        listed = "\n  ".join(f"{document.path.name}: {entry.about}" for entry, document in found)
        raise CalibrationError(f"{folder} has several rigs; give the file itself:\n  {listed}")
    tried = "\n  ".join(reasons) or "it has no such file"
    raise CalibrationError(
        f"{folder} has no rig that trecsim can read; it looked into {', '.join(SUFFIXES)} files:"
        f"\n  {tried}"
    )


def _rigs_among(
    files: list[Path], name: str | None
) -> tuple[list[tuple[Format, Document]], list[str]]:
    """Return the rigs among files (an EasyMocap pair is one), and why the others are none."""
    found: dict[object, tuple[Format, Document]] = {}
    reasons = []
    for file in files:
        try:
            document = read_document(file)
        except CalibrationError as error:
            reasons.append(str(error))
            continue
        entry = recognise(document)
        if entry is None or name not in (None, entry.name):
            reasons.append(f"{file.name}: {'no rig' if entry is None else entry.about}")
        else:
            found.setdefault("pair" if entry.name == "easymocap" else file, (entry, document))
    return list(found.values()), reasons
