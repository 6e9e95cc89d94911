"""The command `trecsim sync`."""

import math
from pathlib import Path

from trecsim.cli.terminal import finish, note
from trecsim.errors import InputError


def sync(
    poses: Path,
    /,
    *,
    rig: Path,
    out: Path,
    out_rig: Path | None = None,
    longest_s: float = 60.0,
    fps: float | None = None,
    json: bool = False,
) -> None:
    """Bring the clocks of cameras into step, by the people whom several of them see.

    For recordings started by hand, of different length and rate. Writes 2D poses whose times are
    those of the first camera's clock.

    Parameters
    ----------
    poses
        2D poses of people who walk.
    rig
        Calibration: poses of the cameras. Offsets of clocks in it are where the search begins.
    out
        The file of 2D poses to write, with mended times: `*.jsonl`.
    out_rig
        Also write the rig with the clocks found (`.toml`), for the poses as they were.
    longest_s
        Clocks differ by so much at most [s].
    fps
        Frames per second, for poses without time stamps.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.people.syncing import sync_clocks
    from trecsim.calibration import read_rig, write_rig
    from trecsim.sources import read_poses
    from trecsim.store.poses_writer import PosesWriter

    if not 0.0 < longest_s <= 3600.0:
        raise InputError(f"--longest-s: expected a time of up to 3600 s, got {longest_s:g}")
    if out.exists() and poses.exists() and out.resolve() == poses.resolve():
        raise InputError(f"--out: {out} is the file that is read; give another name")
    if out_rig is not None and out_rig.resolve() == out.resolve():
        raise InputError(
            f"--out-rig: {out_rig} is the file of 2D poses to write; give another name"
        )
    cameras = read_rig(rig, remark=note)
    images = list(read_poses(poses, rig_cameras=cameras.names, fps=fps, remark=note))
    found = sync_clocks(images, cameras, longest_s=longest_s)
    mended = sorted((found.mended(image, cameras) for image in images), key=lambda one: one.t_s)
    with PosesWriter(out) as writer:
        for image in mended:
            writer.write(image)
    if out_rig is not None:
        write_rig(found.rig, out_rig, format="trecsim", remark=note)
    if found.result.verdict == "wrong":
        note(f"{out} is written, but do not use it: {found.result.reasons[0]}")
    summary = {
        "out": out,
        "images": len(mended),
        "cameras": {
            one.name: {
                "time_offset_s": one.time_offset_s,
                "time_drift_ppm": one.time_drift_ppm,
                "time_offset_sd_s": float(sd),
            }
            for one, sd in zip(found.result.cameras, found.offset_sd_s, strict=True)
        },
        "time_ref_s": found.result.time_ref_s,
        "verdict": found.result.verdict,
        "reasons": list(found.result.reasons),
    }
    lines = [f"{out}: {found.result.verdict}, {len(mended)} images"]
    lines += [f"  - {reason}" for reason in found.result.reasons]
    lines += [
        f"  {one.name}: {one.time_offset_s:+.4f} s, {one.time_drift_ppm:+.0f} ppm"
        if math.isfinite(one.time_offset_s)
        else f"  {one.name}: keeps its clock"
        for one in found.result.cameras
    ]
    finish(summary, json, "\n".join(lines))
