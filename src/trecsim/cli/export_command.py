"""The command `trecsim export`."""

from pathlib import Path

from trecsim.cli.terminal import counted_people, finish, progress_bar


def export(tracks: Path, out: Path, /, *, provisional: bool = False, json: bool = False) -> None:
    """Convert tracks to another format.

    CSV and Parquet hold the same numbers to the last digit. A recording that a crash or a power
    failure cut off is read from the parts beside it.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, or the directory of a recording.
    out
        The file to write; its suffix, `.csv` or `.parquet`, sets the format.
    provisional
        Also write provisional people to a CSV file, which has no column for their state. Parquet
        gets all that there are, with their state.
    json
        Print the summary as one JSON object.
    """
    from trecsim.store.tracks import export_tracks

    with progress_bar("frames", quiet=json) as bar:
        extent = export_tracks(tracks, out, bar, provisional=provisional)
    summary = {
        "out": out,
        "moments": extent.moments,
        "people": extent.people,
        "rows": extent.rows,
        "first_s": extent.first_s,
        "last_s": extent.last_s,
    }
    text = f"{out}: {extent.moments} frames, {counted_people(extent.people)}, {extent.rows} rows"
    finish(summary, json, text)
