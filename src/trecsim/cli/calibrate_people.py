"""The command `trecsim calibrate people`: cameras from people who walk."""

from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import finish, note
from trecsim.errors import InputError

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
        Also write a report to this HTML file: verdict, cameras, map of the expected error.
    fps
        Frames per second, for poses without time stamps.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.people.calibrate import calibrate_people
    from trecsim.calibration import read_intrinsics, write_rig
    from trecsim.sources import read_poses

    if not out.name.lower().endswith(".toml"):
        raise InputError(f"--out: expected a rig file that ends in .toml, got {out}")
    if out.exists() and intrinsics.exists() and out.samefile(intrinsics):
        raise InputError(
            f"--out: {out} is the file of the intrinsics, whose poses would be lost; give another "
            "name"
        )
    if report is not None:
        refuse_report_over_rig(report, out)
    cameras = read_intrinsics(intrinsics)
    images = read_poses(poses, rig_cameras=cameras.names, fps=fps, remark=note)
    made = calibrate_people(images, cameras, distance=distance, stature_m=stature_m)
    write_rig(made.rig, out, format="trecsim", remark=note)
    if report is not None:
        from trecsim.lab.report.calibration_page import write_calibration_report

        write_calibration_report(
            report, "Calibration from people", made.result, rig=made.rig,
            covariance=made.covariance, source=poses.name,
        )  # fmt: skip
    lost = [name for name in cameras.names if name not in made.rig]
    if lost:
        note(f"{out} lacks {', '.join(map(repr, lost))}: not found")
    if made.result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {made.result.reasons[0]}")
    finish(made.result.summary(), json, told(out, made.result))


def refuse_report_over_rig(report: Path, out: Path) -> None:
    """Refuse a report that would take the place of the rig file, which is written before it."""
    if report.resolve() == out.resolve():
        raise InputError(f"--report: {report} is the rig file to write; give another name")


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
