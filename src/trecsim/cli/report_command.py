"""The command `trecsim report`."""

import math
from pathlib import Path

from trecsim.cli.terminal import finish, progress_bar


def report(
    recording: Path,
    /,
    *,
    out: Path | None = None,
    rig: Path | None = None,
    poses: Path | None = None,
    truth: Path | None = None,
    lengths: Path | None = None,
    from_s: float = 0.0,
    to_s: float = math.inf,
    left_out: bool | None = None,
    json: bool = False,
) -> None:
    """Write a report on a recording: one HTML page with quality checks.

    The page shows a summary with warnings, the people over time, their paths and skeletons, limb
    lengths, cameras, uncertainty, errors against ground truth where there is one, and compute
    time. It is one self-contained file, for light and dark screens and for A4 paper. Where input
    for a part is missing, the page says which.

    Parameters
    ----------
    recording
        A folder written by `trecsim run`, a folder with tracks, rig and poses, or a file of
        tracks.
    out
        The page to write (default: `report.html` in the folder of the recording).
    rig
        The cameras, if not in the folder: any format that `trecsim rig show` reads.
    poses
        The 2D poses the tracks were computed from, if not in the folder.
    truth
        Ground truth (`truth.npz`), if not in the folder.
    lengths
        Limb lengths measured with a tape, to compare with (TOML).
    from_s
        Begin this long after the start of the recording [s].
    to_s
        End this long after the start of the recording [s].
    left_out
        Track once more without each camera, and show whether its key points are where the others
        say, as surely as they say; needs the rig and the 2D poses of three cameras or more. Done by
        itself without ground truth up to 12,000 images.
    json
        Print a summary as one JSON object.
    """
    from trecsim.lab.report.building import report as build

    with progress_bar("frames", quiet=json) as bar:
        made = build(
            recording,
            out,
            rig=rig,
            poses=poses,
            truth=truth,
            lengths=lengths,
            from_s=from_s,
            to_s=to_s,
            left_out=left_out,
            progress=bar,
        )
    identities = f"{made.identities} identit{'y' if made.identities == 1 else 'ies'}"
    told = [f"{made.out}: {identities} in {made.length_s:.1f} s"]
    told += [f"  warning: {warning}" for warning in made.warnings]
    finish({name: getattr(made, name) for name in made.__slots__}, json, "\n".join(told))
