"""The command `trecsim export`."""

from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import counted_people, finish, note, progress_bar

if TYPE_CHECKING:
    from trecsim.export import Exported


def export(
    tracks: Path,
    out: Path,
    /,
    *,
    rate_hz: float | None = None,
    person: int | None = None,
    fill_s: float = 0.0,
    lag_s: float | None = None,
    butterworth_hz: float | None = None,
    opensim: bool = False,
    provisional: bool = False,
    json: bool = False,
) -> None:
    """Convert tracks to another format: tables, OpenSim, C3D, Blender, USD, PedPy and others.

    The ending of OUT chooses the format: .csv .parquet .json .trc .c3d .bvh .glb .usda .nc
    .pedpy.txt .rrd, and .angles.csv and .mot for joint angles. Formats that hold one person get a
    file for each: walk_0.trc for person 0 of walk.trc. Missing positions stay missing. A recording
    that a crash or a power failure cut off is read from the parts beside it.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, or the directory of a recording.
    out
        The file to write.
    rate_hz
        Frames per second, on the spline through the tracks (default: the recorded times, or the
        usual rate of the tracks for formats with a fixed rate).
    person
        Export this person only.
    fill_s
        Fill gaps up to this length by the spline [s].
    lag_s
        Smooth: each position becomes that of the parabola through all that are at most this long
        before and after it [s]; zero phase.
    butterworth_hz
        Smooth: Butterworth filter of order 4 with this cut-off frequency [Hz], forwards and
        backwards; zero phase.
    opensim
        Beside TRC files, also write a marker set and setups for OpenSim's scaling and inverse
        kinematics.
    provisional
        Also export provisional people. Parquet gets all that there are, with their state.
    json
        Print the summary as one JSON object.
    """
    from trecsim.export import ExportSettings, export_tracks
    from trecsim.export.smoothing import Smoothing

    settings = ExportSettings(
        rate_hz, person, fill_s, Smoothing(lag_s, butterworth_hz), provisional, opensim
    )
    with progress_bar("frames", quiet=json) as bar:
        done = export_tracks(tracks, out, bar, settings=settings)
    for remark in _remarks(done):
        note(remark)
    summary = {name: getattr(done, name) for name in done.__slots__}
    finish({"out": out, **summary}, json, _text(done))


def _text(done: "Exported") -> str:
    names = str(done.files[0])
    if len(done.files) > 1:
        names += f" to {done.files[-1].name} ({len(done.files)} files)"
    rate = f" at {done.rate_hz:.6g} frames per second" if done.rate_hz else ""
    text = f"{names}: {done.moments} frames{rate}, {counted_people(done.people)}, {done.rows} rows"
    return text if done.smoothing == "none" else f"{text}; smoothed: {done.smoothing}"


def _remarks(done: "Exported") -> list[str]:
    remarks = []
    if done.held:
        remarks.append(
            f"{done.held} frames without tracks show the last pose, because {done.format} has no "
            "gaps; --fill-s moves through them instead"
        )
    elif done.missing:
        remarks.append(f"{done.missing} frames without tracks are left empty; see --fill-s")
    if done.left_out:
        listed = ", ".join(map(str, done.left_out[:20]))
        remarks.append(f"not seen at two frames in a row at this rate, left out: {listed}")
    return remarks
