"""The command `trecsim day-report`."""

from datetime import date as calendar_date
from pathlib import Path

from trecsim.cli.terminal import counted, counted_people, finish, note, progress_bar
from trecsim.errors import InputError


def day_report(
    site: Path,
    /,
    *,
    date: str | None = None,
    recordings: Path | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Write the report of a day of a site: alerts, counts, dwell and density on one HTML page.

    Alerts of each rule with the reasons they were closed with, the rate of false alarms, and how
    long it took to acknowledge them; visits and dwell by zone, crossings by line, ways between
    them, Voronoi density with levels of service, and a map of where people were. Rules are
    advisory; they are no certified safety function.

    Parameters
    ----------
    site
        The site file.
    date
        Which day, as `2026-11-30`, in the local time of the site (default: the last one recorded).
    recordings
        Folder with the recordings and events of the site, or of one recording (default: where the
        site file says).
    out
        The page to write (default: `day-DATE.html` in that folder).
    json
        Print a summary as one JSON object.
    """
    from trecsim.lab.day.day_building import day_report as build

    day = None if date is None else _read(date)
    folder = recordings or _recordings_of(site)
    out = out or folder / f"day-{date or 'report'}.html"
    with progress_bar("moments", quiet=json) as bar:
        made = build(site, folder, out, day=day, progress=bar)
    for remark in made.remarks:
        note(remark)
    told = (
        f"{made.out}: {counted(made.alerts, 'alert')}, {counted_people(made.people)} in "
        f"{made.watched_s / 3600.0:.2f} h"
    )
    finish({name: getattr(made, name) for name in made.__slots__}, json, told)


def _read(text: str) -> calendar_date:
    try:
        return calendar_date.fromisoformat(text)
    except ValueError:
        raise InputError(f"--date: expected a day as 2026-11-30, found {text!r}") from None


def _recordings_of(site: Path) -> Path:
    from trecsim.site_run import recordings_folder
    from trecsim.sites.site_reading import read_site

    return recordings_folder(read_site(site))
