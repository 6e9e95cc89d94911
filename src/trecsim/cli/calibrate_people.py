"""The command `trecsim calibrate people`: cameras from people who walk."""

from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.calibration_files import refuse_over_intrinsics, report_of, write_report
from trecsim.cli.terminal import finish, note

if TYPE_CHECKING:
    from trecsim.calibrating.result import CalibrationResult


def people(
    poses: Path,
    /,
    *,
    intrinsics: Path,
    out: Path,
    distance: tuple[str, str, float] | None = None,
    stature_m: float | None = None,
    report: Path | None = None,
    fps: float | None = None,
    json: bool = False,
) -> None:
    """Calibrate cameras from people who walk: poses, clocks, and a verdict.

    Nobody carries anything, several people may walk at once, and the cameras need not be
    synchronised. The frame of the rig has z up and the floor at 0; its origin is where people
    walked.

    Parameters
    ----------
    poses
        2D poses: what `trecsim estimate` writes, or any format that `trecsim track` reads.
    intrinsics
        A rig file; poses in it are not used.
    out
        The rig file to write: the cameras that were found.
    distance
        Two cameras and the distance between them [m], for the scale.
    stature_m
        Mean stature of the people [m], for the scale where no distance is given (default: 1.70).
    report
        The report to write: verdict, cameras, map of the expected error (default: beside the rig
        file, `*.html`).
    fps
        Frames per second, for poses without time stamps.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.people.calibrate import calibrate_people
    from trecsim.calibration import read_intrinsics, write_rig
    from trecsim.sources import read_poses

    page = report_of(out, report)
    refuse_over_intrinsics(out, intrinsics)
    cameras = read_intrinsics(intrinsics)
    images = read_poses(poses, rig_cameras=cameras.names, fps=fps, remark=note)
    made = calibrate_people(images, cameras, distance=distance, stature_m=stature_m)
    write_rig(made.rig, out, format="trecsim", remark=note)
    write_report(
        page, "Calibration from people", made.result, asked=report is not None,
        rig=made.rig, covariance=made.covariance, source=poses.name,
    )  # fmt: skip
    lost = [name for name in cameras.names if name not in made.rig]
    if lost:
        note(f"{out} lacks {', '.join(map(repr, lost))}: not found")
    if made.result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {made.result.reasons[0]}")
    finish(made.result.summary(), json, told(out, made.result))


def told(out: Path, result: "CalibrationResult") -> str:
    """Return a result in lines."""
    lines = [f"{out}: {result.verdict}"]
    lines += [f"  - {reason}" for reason in result.reasons]
    for camera in result.cameras:
        if camera.rotation_sd_deg == camera.rotation_sd_deg:
            lines.append(
                f"  {camera.name}: turn +- {camera.rotation_sd_deg:.3f} deg, place +- "
                f"{100 * camera.position_sd_m:.1f} cm, clock {camera.time_offset_s:+.4f} s "
                f"{camera.time_drift_ppm:+.0f} ppm, {camera.reprojection_px:.1f} px"
            )
        else:
            lines.append(f"  {camera.name}: not found")
    return "\n".join(lines)
