"""USD: one set of time-sampled points per person, z up, metres. The text needs no package."""

import errno
import os
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from shutil import disk_usage
from typing import TextIO

import numpy as np

from trecsim.export.base import About
from trecsim.export.held import held, visible_changes
from trecsim.export.motions import Motion, PersonMotion
from trecsim.export.person_colours import rgb

_WIDTH_M = 0.06
_LITTLE_ROOM = 1 << 20  # bytes


def write_usd(motion: Motion, path: Path, about: About) -> None:
    """Write everybody as USD; a person who is absent is invisible, a missing joint has width 0."""
    per_second = motion.rate_hz or 1000.0
    ends = [float(one.t_s[-1]) - motion.t0_s for one in motion.people]
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(
            '#usda 1.0\n(\n    defaultPrim = "people"\n    metersPerUnit = 1\n    upAxis = "Z"\n'
            f"    startTimeCode = 0\n    endTimeCode = {max(ends, default=0.0) * per_second:.10g}\n"
            f"    timeCodesPerSecond = {per_second:.10g}\n"
            f"    customLayerData = {{\n        double first_time_s = {motion.t0_s!r}\n"
            "    }\n)\n\n"
            'def Xform "people"\n{\n'
        )
        for one in motion.people:
            _write_person(file, one, motion, per_second, about)
        file.write("}\n")


def write_binary_usd(motion: Motion, path: Path, about: About) -> None:
    """Write the same as a binary file, two fifths of the size."""
    sdf, tf = import_module("pxr.Sdf"), import_module("pxr.Tf")
    text = path.with_suffix(".usda")
    try:
        write_usd(motion, text, about)
        sdf.Layer.FindOrOpen(str(text)).Export(str(path))
    except tf.ErrorException as error:  # it has no number to tell a full disk by
        full = disk_usage(path.parent).free < _LITTLE_ROOM
        code = errno.ENOSPC if full else errno.EIO
        raise OSError(code, os.strerror(code)) from error
    finally:
        text.unlink(missing_ok=True)


def _write_person(
    file: TextIO, one: PersonMotion, motion: Motion, per_second: float, about: About
) -> None:
    codes = [f"{code:.10g}" for code in ((one.t_s - motion.t0_s) * per_second).tolist()]
    known = one.known
    joints = ", ".join(f'"{joint}"' for joint in about.skeleton.joints)
    red, green, blue = rgb(one.person)
    file.write(
        f'    def Points "person_{one.person}"\n    {{\n'
        f"        custom int trecsim:person = {one.person}\n"
        f"        uniform token[] trecsim:joints = [{joints}]\n"
        f"        color3f[] primvars:displayColor = [({red}, {green}, {blue})]\n"
        "        token visibility.timeSamples = {\n"
    )
    for at, there in visible_changes(one.present, one.t_s, motion.longest_step_s):
        file.write(f'            {(at - motion.t0_s) * per_second:.10g}: "')
        file.write(f'{"inherited" if there else "invisible"}",\n')
    file.write("        }\n        float[] widths.timeSamples = {\n")
    for number, widths in _changes(np.where(known, _WIDTH_M, 0.0)):
        file.write(f"            {codes[number]}: [{', '.join(f'{w:g}' for w in widths)}],\n")
    file.write("        }\n        point3f[] points.timeSamples = {\n")
    for code, row in zip(codes, held(one.xyz_m).reshape(len(codes), -1), strict=True):
        file.write(f"            {code}: [")
        file.write(_POINTS % tuple(row.tolist()))
        file.write("],\n")
    file.write("        }\n    }\n")


_POINTS = ", ".join(["(%.7g, %.7g, %.7g)"] * 17)


def _changes(rows: np.ndarray) -> Iterator[tuple[int, list[float]]]:
    """Yield the rows on both sides of each change: USD interpolates between samples."""
    differs = (rows[1:] != rows[:-1]).any(axis=1)
    changed = np.concatenate([[True], differs]) | np.concatenate([differs, [False]])
    for number in np.flatnonzero(changed).tolist():
        yield number, rows[number].tolist()
