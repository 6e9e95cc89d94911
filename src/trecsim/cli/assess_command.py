"""The command `trecsim assess`."""

from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import counted, counted_people, finish, note, progress_bar

if TYPE_CHECKING:
    from trecsim.assessing import AssessSummary


def assess(
    tracks: Path,
    site: Path,
    /,
    *,
    out: Path = Path("events.jsonl"),
    start: str | None = None,
    json: bool = False,
) -> None:
    """Judge the rules of a site file on recorded tracks; write the events.

    The same code as live: on the recording of a live site it gives the same events. The rules are
    advisory; they are no certified safety function.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, or the directory of a recording.
    site
        The site file with the rules. Its cameras and outputs may be missing and are not opened.
    out
        The file to write: `*.jsonl`, one event a line (CloudEvents 1.0).
    start
        When the recording began, for schedules, as `2026-01-31T22:00` in the local time of the
        site; only for recordings that do not know it.
    json
        Print the summary as one JSON object.
    """
    from trecsim.assessing import assess as run

    with progress_bar("moments", quiet=json) as bar:
        summary = run(tracks, site, out, start=start, progress=bar)
    for remark in summary["remarks"]:
        note(remark)
    finish(summary, json, _told(summary))


def _told(summary: "AssessSummary") -> str:
    heading = (
        f"{summary['out']}: {counted(summary['episodes'], 'episode')} of "
        f"{counted_people(summary['people'])} in {counted(summary['moments'], 'moment')}"
    )
    rules = [f"  {name}: {number}" for name, number in summary["by_rule"].items()]
    return "\n".join([heading, *rules])
