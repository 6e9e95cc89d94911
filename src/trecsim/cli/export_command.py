"""The command `trecsim export`."""

from pathlib import Path

from trecsim.cli.terminal import counted_people, finish, progress_bar


def export(tracks: Path, out: Path, /, *, json: bool = False) -> None:
    """Turn recorded tracks into another format.

    CSV becomes Parquet and back without a difference. A recording that was cut off, by a crash
    or a power failure, is read from the parts beside it.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, or the directory of a recording.
    out
        The file to write; its suffix, `.csv` or `.parquet`, decides.
    json
        Print the summary as one JSON object.
    """
    from trecsim.store.tracks import export_tracks

    with progress_bar("moments", quiet=json) as bar:
        extent = export_tracks(tracks, out, bar)
    summary = {
        "out": out,
        "moments": extent.moments,
        "people": extent.people,
        "rows": extent.rows,
        "first_s": extent.first_s,
        "last_s": extent.last_s,
    }
    text = f"{out}: {extent.moments} moments, {counted_people(extent.people)}, {extent.rows} rows"
    finish(summary, json, text)
