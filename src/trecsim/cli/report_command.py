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
    json: bool = False,
) -> None:
    """Show a recording on one page: who was where, and how far it can be trusted.

    The page is one HTML file that needs nothing else: summary and warnings, people over time
    against fit time, paths, time spent, limb lengths, cameras, uncertainty, and the error where
    the truth is known. It follows light and dark, and prints on A4. What is missing for a part is
    said in its place.

    Parameters
    ----------
    recording
        A folder that `trecsim run` has made, one with tracks beside rig and poses, or a file of
        tracks.
    out
        The page to write. Without it, `report.html` in the folder of the recording.
    rig
        The cameras, if not in the folder: any format that `trecsim rig show` reads.
    poses
        The 2D poses the tracks were made of, if not in the folder.
    truth
        Where everybody truly was (`truth.npz`), if not in the folder.
    lengths
        Limb lengths measured with a tape, to compare with (TOML).
    from_s
        Begin this long after the start of the recording [s].
    to_s
        End this long after the start of the recording [s].
    json
        Print a summary as one JSON object.
    """
    from trecsim.lab.report.building import report as build

    with progress_bar("moments", quiet=json) as bar:
        made = build(
            recording,
            out,
            rig=rig,
            poses=poses,
            truth=truth,
            lengths=lengths,
            from_s=from_s,
            to_s=to_s,
            progress=bar,
        )
    identities = f"{made.identities} identit{'y' if made.identities == 1 else 'ies'}"
    told = [f"{made.out}: {identities} in {made.length_s:.1f} s"]
    told += [f"  look at this: {warning}" for warning in made.warnings]
    finish({name: getattr(made, name) for name in made.__slots__}, json, "\n".join(told))
