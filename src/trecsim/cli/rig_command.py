"""The commands `trecsim rig`: show and convert calibrations."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from trecsim.cli.rig_options import RigOptions
from trecsim.cli.terminal import finish, note

if TYPE_CHECKING:
    from trecsim.geometry.camera import Camera
    from trecsim.geometry.rig import Rig

Reading = Annotated[RigOptions, Parameter(name="*")]
WIDTH_OF_FILES = 140  # letters of a table that does not go to a terminal


def show(
    rig: Path,
    /,
    *,
    out: Path | None = None,
    reading: Reading = RigOptions(),  # noqa: B008
    json: bool = False,
) -> None:
    """Show the cameras of a rig: a table, and a picture from above.

    Parameters
    ----------
    rig
        A rig file, or a directory with one, in any format that is read.
    out
        Draw the cameras and what they see of the floor to this file: .png, .svg, .pdf or .jpg.
    json
        Print the summary as one JSON object.
    """
    found = reading.read(rig)
    summary = {
        "rig": rig,
        "cameras": [_facts(camera) for camera in found],
        "picture": out,
    }
    if out is not None:
        from trecsim.lab.plots.canvas import save_figure
        from trecsim.lab.plots.rig_plot import rig_figure

        save_figure(rig_figure(found, rig.resolve().name), out)
    text = _table(found)
    if out is not None:
        text += f"\n{out}: the cameras from above"
    finish(summary, json, text)


def convert(
    rig: Path,
    out: Path,
    /,
    *,
    format: str | None = None,
    out_unit_m: float = 1.0,
    reading: Reading = RigOptions(),  # noqa: B008
    json: bool = False,
) -> None:
    """Convert a rig to another format.

    Parameters
    ----------
    rig
        A rig file, or a directory with one, in any format that is read.
    out
        The file to write; for EasyMocap, the directory.
    format
        Format to write: trecsim, mc-calib, pose2sim, anipose or easymocap. Without it the name of
        the file decides: Calib*.toml is Pose2Sim, any other .toml trecsim, .yml MC-Calib, a name
        without suffix EasyMocap.
    out_unit_m
        Length unit of the file to write, in metres.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibration import format_to_write, write_rig

    chosen = format_to_write(out, format)
    found = reading.read(rig)
    write_rig(found, out, format=chosen.name, unit_m=out_unit_m, remark=note)
    summary = {"out": out, "format": chosen.name, "cameras": list(found.names)}
    finish(summary, json, f"{out}: {len(found)} cameras as {chosen.about}")


def _facts(camera: "Camera") -> dict[str, Any]:
    """Return the row of a camera in the table."""
    import numpy as np

    from trecsim.geometry.view import field_of_view_deg

    ahead = camera.T_cam_world[2, :3]
    angle_deg, complete = field_of_view_deg(camera)
    return {
        "name": camera.name,
        "size_px": camera.size_px,
        "focal_px": [float(camera.K[0, 0]), float(camera.K[1, 1])],
        "horizontal_view_deg": angle_deg,
        "whole_view_usable": complete,
        "position_m": camera.position_m,
        "azimuth_deg": float(np.rad2deg(np.arctan2(ahead[1], ahead[0]))),
        "down_deg": float(np.rad2deg(np.arcsin(np.clip(-ahead[2], -1, 1)))),
        "distortion_model": camera.distortion_model,
        "distortion": camera.distortion,
        "time_offset_s": camera.time_offset_s,
        "time_drift_ppm": camera.time_drift_ppm,
        "time_ref_s": camera.time_ref_s,
    }


def _table(rig: "Rig") -> str:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("camera", overflow="fold", no_wrap=False)
    headers = ("size px", "f px", "view deg", "x m", "y m", "height m", "looks deg", "down deg")
    for header in headers:
        table.add_column(header, justify="right", no_wrap=True)
    table.add_column("distortion")
    late = any(camera.time_offset_s or camera.time_drift_ppm for camera in rig)
    if late:
        table.add_column("offset s", justify="right", no_wrap=True)
    for camera in rig:
        table.add_row(*map(Text, _row(_facts(camera), late)))  # brackets are no markup
    terminal = sys.stdout.isatty()
    console = Console(width=None if terminal else WIDTH_OF_FILES, force_terminal=terminal)
    with console.capture() as capture:
        console.print(table)
    lines = [line.rstrip() for line in capture.get().splitlines() if line.strip()]
    legend = (
        "view: horizontal field of view, of the whole image (>: of the part the lens model reaches)"
        "; looks: 0 along x, 90 along y"
    )
    return "\n".join([*lines, legend])


def _row(facts: dict[str, Any], late: bool) -> list[str]:
    fx, fy = facts["focal_px"]
    x_m, y_m, z_m = facts["position_m"]
    coefficients = ", ".join(f"{value:.4g}" for value in facts["distortion"])
    row = [
        facts["name"],
        "{} x {}".format(*facts["size_px"]),
        f"{fx:.0f}" if round(fx) == round(fy) else f"{fx:.0f}, {fy:.0f}",
        f"{'' if facts['whole_view_usable'] else '> '}{facts['horizontal_view_deg']:.1f}",
        *(f"{value:z.2f}" for value in (x_m, y_m, z_m)),
        *(f"{facts[key]:z.0f}" for key in ("azimuth_deg", "down_deg")),
        f"{facts['distortion_model']} {coefficients}".rstrip(),
    ]
    drift = f", {facts['time_drift_ppm']:g} ppm" if facts["time_drift_ppm"] else ""
    return [*row, f"{facts['time_offset_s']:g}{drift}"] if late else row
