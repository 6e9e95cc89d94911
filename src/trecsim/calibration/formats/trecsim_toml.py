"""The rig file of trecsim, ``rig.toml``: metres, z up, floor at z = 0; unknown keys are faults."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibration.formats.document import Document
from trecsim.calibration.formats.fields import Entry, Faults, short
from trecsim.calibration.formats.read_options import ReadOptions
from trecsim.calibration.formats.rig_building import apply_floor
from trecsim.calibration.formats.rig_remarks import remark_on_cameras
from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.camera_faults import CLOCK_LIMITS
from trecsim.geometry.rig import Rig
from trecsim.store.atomic import atomic_write

FORMAT = "trecsim.rig/1"
KEYS = (
    "size_px",
    "K",
    "distortion_model",
    "distortion",
    "T_cam_world",
    *CLOCK_LIMITS,
)


def recognise(data: Mapping[str, Any]) -> bool:
    """Return whether the file is a rig file of trecsim, of any version."""
    return str(data.get("format", "")).startswith("trecsim.rig")


def read(document: Document, options: ReadOptions) -> Rig:
    """Read a ``rig.toml``."""
    faults = Faults(document.path)
    top = Entry("the file", document.data, faults)
    top.unknown(("format", "cameras"))
    if document.data.get("format") != FORMAT:
        top.fault(
            f"format must be {FORMAT!r}, found {short(document.data.get('format'))}; "
            "a newer trecsim may have written it"
        )
    if options.unit_m not in (None, 1.0):
        top.fault("it is in metres always; do not give a unit")
    if not top.has("cameras"):
        top.missing("cameras", "a table [cameras.NAME] for each camera")
    tables = document.data.get("cameras", {})
    if not isinstance(tables, Mapping):
        top.fault(f"cameras must be tables [cameras.NAME], found {short(tables)}")
        tables = {}
    elif top.has("cameras") and not tables:
        top.fault("it has no camera, expected a table [cameras.NAME] for each")
    cameras = [_camera(name, table, faults, options) for name, table in tables.items()]
    faults.check()
    rig = Rig(tuple(camera for camera in cameras if camera is not None))
    if options.intrinsics_only:
        return rig
    rig = apply_floor(rig, options, z_up=True)
    remark_on_cameras(rig, options)
    return rig


def _camera(name: str, table: object, faults: Faults, options: ReadOptions) -> Camera | None:
    entry = Entry(f"camera {name!r}", table, faults)
    before = len(faults.texts)
    entry.unknown(KEYS)
    size_px = entry.size_px("size_px")
    K = entry.numbers("K", (3, 3))
    T_cam_world = _pose(entry, options)
    distortion = entry.coefficients("distortion") if entry.has("distortion") else np.empty(0)
    clock = {name: entry.number(name, 0.0) for name in CLOCK_LIMITS}
    if len(faults.texts) > before:
        return None
    try:
        return Camera(
            name,
            size_px,
            K,
            T_cam_world,
            entry.fields.get("distortion_model", "none"),
            distortion,
            **clock,
        )
    except CalibrationError as error:
        faults.add(str(error))
        return None


def _pose(entry: Entry, options: ReadOptions) -> Float64[np.ndarray, "4 4"]:
    if entry.has("T_cam_world"):
        return entry.numbers("T_cam_world", (4, 4))
    if not options.intrinsics_only:
        entry.missing(
            "T_cam_world",
            "4 x 4 numbers; a file of intrinsics alone becomes a rig by `trecsim calibrate rig`",
        )
    return np.eye(4)


def write(rig: Rig, path: Path, unit_m: float) -> list[str]:
    """Write a ``rig.toml``; what is read back is the same to the last bit."""
    if unit_m != 1.0:
        raise CalibrationError("a trecsim rig file is in metres always; do not give a unit")
    _write(rig, path, poses=True)
    return []


def write_intrinsics(rig: Rig, path: Path) -> None:
    """Write a ``rig.toml`` without the cameras' poses."""
    _write(rig, path, poses=False)


def _write(rig: Rig, path: Path, *, poses: bool) -> None:
    lines = [f'format = "{FORMAT}"']
    for camera in rig:
        lines += ["", *(line for line in _table(camera) if poses or not line.startswith("T_"))]
    with atomic_write(path) as file:
        file.write("\n".join(lines) + "\n")


def _table(camera: Camera) -> Iterable[str]:
    yield f"[cameras.{quoted(camera.name)}]"
    yield f"size_px = [{camera.size_px[0]}, {camera.size_px[1]}]"
    yield f"K = {matrix(camera.K)}"
    yield f'distortion_model = "{camera.distortion_model}"'
    yield f"distortion = {vector(camera.distortion)}"
    yield f"T_cam_world = {matrix(camera.T_cam_world)}"
    yield f"time_offset_s = {camera.time_offset_s!r}"
    if camera.time_drift_ppm or camera.time_ref_s:
        yield f"time_drift_ppm = {camera.time_drift_ppm!r}"
        yield f"time_ref_s = {camera.time_ref_s!r}"


def quoted(text: str) -> str:
    """Return a printable text as TOML writes it."""
    return json.dumps(text, ensure_ascii=False)


def vector(values: Float64[np.ndarray, " number"]) -> str:
    """Return a list of numbers as TOML writes it."""
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def matrix(values: Float64[np.ndarray, "row column"]) -> str:
    """Return a matrix as TOML writes it, a list of rows."""
    return "[" + ", ".join(vector(row) for row in values) + "]"
