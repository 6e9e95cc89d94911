"""What a recording lacks when no rig can be computed, and how to record it."""

from collections.abc import Sequence

import numpy as np

from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.floor_tracks import floor_tracks
from trecsim.calibrating.people.tracklets import tracklets
from trecsim.calibrating.people.tuning import EXTENT_M, SHORTEST_OVERLAP_S
from trecsim.calibrating.people.uprights import level
from trecsim.errors import CalibrationError

HOW = (
    "let one to three people walk for 40 s, in curves, over the whole floor that the cameras share"
)


def refuse(recorded: Sequence[CameraRecord]) -> None:
    """Reject a recording in which fewer than two cameras saw anybody.

    Raises
    ------
    CalibrationError
        The message says which cameras saw nobody, and how to record.
    """
    if len(recorded) < 2:
        raise CalibrationError(
            f"a rig needs at least two cameras, the intrinsics have {len(recorded)}"
        )
    seeing = [one for one in recorded if len(one.xy)]
    if len(seeing) >= 2:
        return
    if not seeing:
        raise CalibrationError(f"no camera saw anybody; {HOW}")
    others = ", ".join(repr(one.name) for one in recorded if not len(one.xy))
    raise CalibrationError(
        f"only camera {seeing[0].name!r} saw anybody, {others} nobody: people must be seen by two "
        f"cameras and more; {HOW}"
    )


def unrelated(recorded: Sequence[CameraRecord]) -> CalibrationError:
    """Return the error of a recording that relates no two cameras; the message says why."""
    return CalibrationError(f"no two cameras could be related: {_why(recorded)}")


def _why(recorded: Sequence[CameraRecord]) -> str:
    own = [tracklets(record, c) for c, record in enumerate(recorded)]
    untracked = [r.name for r, tracks in zip(recorded, own, strict=True) if not tracks]
    if len(untracked) > len(recorded) - 2:
        return (
            f"{_listed(untracked)} saw nobody for longer than half a second; are the images less "
            f"than half a second apart? {HOW}"
        )
    levels = [level(record, tracks) for record, tracks in zip(recorded, own, strict=True)]
    cut = [r.name for r, one in zip(recorded, levels, strict=True) if one is None]
    if len(cut) > len(recorded) - 2:
        return (
            f"{_listed(cut)} hardly saw anybody from head to foot: turn the cameras down or let "
            f"people walk further away; {HOW}"
        )
    moved, longest = 0.0, 0.0
    for record, tracks, one in zip(recorded, own, levels, strict=True):
        if one is None:
            continue
        floor = floor_tracks(record, tracks, one.T_level_cam)
        for start, stop in zip(floor.first[:-1], floor.first[1:], strict=True):
            if stop > start:
                moved = max(moved, float(np.sqrt(floor.xy_m[start:stop].var(axis=0).sum())))
        longest = max([longest, *(float(np.ptp(track.t_s)) for track in tracks)])
    if longest < SHORTEST_OVERLAP_S:
        return f"nobody was seen for longer than {longest:.1f} s at a time; {HOW}"
    if moved < 2.0 * EXTENT_M:
        return f"nobody walked: people moved by {moved:.1f} m only; {HOW}"
    return (
        "no motion of one camera's floor brings its people to those of another: do the cameras see "
        "the same people, and do their clocks differ by less than 30 s? Are the names of the "
        f"cameras exchanged? {HOW}"
    )


def _listed(names: Sequence[str]) -> str:
    return ("camera " if len(names) == 1 else "cameras ") + ", ".join(map(repr, names))
