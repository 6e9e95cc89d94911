"""The commands `trecsim calibrate check` and `trecsim calibrate repair`."""

from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.calibrate_people import told
from trecsim.cli.calibration_files import report_of, write_report
from trecsim.cli.terminal import finish, note
from trecsim.errors import InputError

if TYPE_CHECKING:
    from trecsim.calibrating.people.checking import CameraCheck


def check(
    rig: Path,
    poses: Path,
    /,
    *,
    fps: float | None = None,
    json: bool = False,
) -> None:
    """Check by the people in a recording whether a rig is still right.

    Exit code 0 also when a camera is off.

    Parameters
    ----------
    rig
        Calibration: a file or directory in any format that `trecsim rig show` reads.
    poses
        2D poses of people who walk, from seconds to hours.
    fps
        Frames per second, for poses without time stamps.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.people.checking import check_rig
    from trecsim.calibration import read_rig
    from trecsim.sources import read_poses

    cameras = read_rig(rig, remark=note)
    found = check_rig(read_poses(poses, rig_cameras=cameras.names, fps=fps, remark=note), cameras)
    for remark in found.remarks:
        note(remark)
    summary = {
        "cameras": {one.name: one.row() for one in found.cameras},
        "remarks": list(found.remarks),
    }
    finish(summary, json, "\n".join(_line(one) for one in found.cameras))


def repair(
    rig: Path,
    poses: Path,
    /,
    *,
    out: Path,
    report: Path | None = None,
    fps: float | None = None,
    json: bool = False,
) -> None:
    """Repair a rig by the people in a recording: as it is at the end.

    The old file stays as it is; keep it, to take the repair back.

    Parameters
    ----------
    rig
        Calibration: a file or directory in any format that `trecsim rig show` reads.
    poses
        2D poses of people who walk.
    out
        The rig file to write.
    report
        The report to write: verdict and cameras (default: beside the rig file, `*.html`).
    fps
        Frames per second, for poses without time stamps.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.people.repairing import repair_rig
    from trecsim.calibration import read_rig, write_rig
    from trecsim.sources import read_poses

    page = report_of(out, report)
    if out.exists() and rig.exists() and out.resolve() == rig.resolve():
        raise InputError(
            f"--out: {out} is the rig to repair; give another name, so that the repair can be "
            "taken back"
        )
    cameras = read_rig(rig, remark=note)
    made = repair_rig(read_poses(poses, rig_cameras=cameras.names, fps=fps, remark=note), cameras)
    write_rig(made.rig, out, format="trecsim", remark=note)
    write_report(
        page, "Repaired rig", made.result, asked=report is not None, source=poses.name
    )  # fmt: skip
    if made.result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {made.result.reasons[0]}")
    found = {one.name: one.row() for one in made.check.cameras}
    finish({**made.result.summary(), "check": found}, json, told(out, made.result))


def revoke(site: Path, /, *, out: Path | None = None, json: bool = False) -> None:
    """Take back the repair of a rig that a live site made by itself.

    The rig of the site file is used again: at once by a site that runs, which does not repair the
    same camera again before its next start. The repaired rig stays as a file.

    Parameters
    ----------
    site
        The site file.
    out
        The directory of the run, if `trecsim run` was given one.
    json
        Print the summary as one JSON object.
    """
    from trecsim.service.rig_repairs import RigRepairs
    from trecsim.site_run import recordings_folder
    from trecsim.sites.site_reading import read_site

    repairs = RigRepairs(out or recordings_folder(read_site(site)))
    repair = repairs.revoke()
    if repair is None:
        raise InputError(
            f"{repairs.folder}: no repair is in force; a site repairs its rig by itself only with "
            "automatic = true in [repair]"
        )
    named = ", ".join(repair.turn_deg)
    kept = repairs.folder / repair.rig if repair.rig else None
    text = f"the repair of {named} is taken back; the repaired rig is still in {kept}"
    if kept is None:
        text = f"a repair that could not be read is taken back; {repairs.folder} has what is left"
    finish({"cameras": dict(repair.turn_deg), "rig": kept}, json, text)


def _line(one: "CameraCheck") -> str:
    if one.ok is None:
        return f"{one.name}: unknown, nobody was seen there and in another camera"
    text = (
        f"{one.rotation_deg:.2f} degrees, {100 * one.shift_m:.1f} cm, "
        f"{1e3 * one.time_offset_s:+.0f} ms"
    )
    return (
        f"{one.name}: ok ({text})"
        if one.ok
        else f"{one.name}: off by {text} since {one.since_s:.1f} s"
    )
