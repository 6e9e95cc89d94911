"""The command `trecsim run`."""

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.first_run import compile_first, tell_first_run
from trecsim.cli.models_command import fetch_first
from trecsim.cli.stopping import stopping_in_order
from trecsim.cli.terminal import (
    ProgressBar,
    counted_people,
    finish,
    fusion_time,
    note,
    progress_bar,
)
from trecsim.errors import InputError

if TYPE_CHECKING:
    from trecsim.pipeline import Feed
    from trecsim.run_summary import RunSummary
    from trecsim.sites.check import CheckedSite
    from trecsim.tracking import Tally


def run(
    site: Path,
    /,
    *,
    out: Path | None = None,
    resume: bool = False,
    as_live: bool = False,
    json: bool = False,
) -> None:
    """Run the pipeline of a site file: cameras, videos or 2D poses in, people in 3D out.

    Live cameras are read until the command is stopped: Ctrl-C ends it in order.

    Writes to one directory: the tracks (`tracks.parquet`), the cameras (`rig.toml`), the time of
    each frame set (`timing.csv`), a summary with all settings (`summary.json`), a picture of the
    paths (`paths.png`) and, if the site file asks for them, the 2D poses (`poses.jsonl`).
    `trecsim report` shows all of it. Results so far are kept if the run is interrupted; after a
    crash or a power failure at most the last two seconds are lost. Without a terminal the command
    writes a line of progress once a minute.

    Parameters
    ----------
    site
        The site file. `trecsim site schema` lists its keys.
    out
        Directory to write to. Without it: a directory named by the time, under `recordings`
        beside the site file or where the site file says.
    resume
        Go on with the recording in the directory `--out`, if there is one: after a crash, or where
        it ended. Images up to its end are left out; people get new identities.
    as_live
        Play recordings as if they were live: at their own pace, dated from now on, images left out
        where this machine cannot keep up.
    json
        Print the summary as one JSON object.
    """
    from trecsim.site_run import run as run_site
    from trecsim.sites.check import check_site

    if resume and out is None:
        raise InputError("--resume needs the directory of the recording: give --out DIRECTORY")
    checked = check_site(site)
    for remark in checked.remarks:
        note(remark)
    if checked.file.site.sources:
        fetch_first(checked.file.site.estimator.name, quiet=json)
    if checked.videos:  # the kernels are compiled while the first images are estimated
        tell_first_run(quiet=json)
    else:
        compile_first(quiet=json)
    feed = _live_feed(checked, as_live)
    told = json or sys.stderr.isatty()  # a terminal shows a bar; --json shows nothing
    with progress_bar("images", quiet=json) as bar, stopping_in_order() as stop:
        lines = _Lines(bar)
        summary = run_site(
            checked, out, feed=feed, resume=resume, progress=lines.passed, stop=stop,
            tell=_tell_nothing if told else lines.tell,
            picture=partial(_draw_paths, checked),
        )  # fmt: skip
    if summary.ended == "stopped" and feed is None:
        raise KeyboardInterrupt(f"stopped; {_told(summary)}")
    finish(_facts(summary), json, _told(summary))


def _live_feed(checked: "CheckedSite", as_live: bool) -> "Feed | None":
    """Return what a site delivers live; None where it is run from its recordings."""
    from trecsim.pipeline import Feed
    from trecsim.sites.check import load_estimator
    from trecsim.sites.live_sources import image_sources, poses_source

    if not (as_live or checked.file.site.is_live):
        return None
    if checked.file.site.poses is not None:
        return Feed([poses_source(checked)])
    estimator = load_estimator(checked.file)
    return Feed(image_sources(checked, estimator), estimator)


def _tell_nothing(tally: "Tally") -> None:
    pass


class _Lines:
    """Writes lines of progress where no bar is shown."""

    def __init__(self, bar: ProgressBar) -> None:
        self._bar = bar
        self._images = "0 images"

    def passed(self, done: int, total: int | None) -> None:
        """Move the bar, and remember how many images are done."""
        self._bar(done, total)
        share = f" of {total} ({100 * done / total:.0f} %)" if total else ""
        self._images = f"{done}{share} images"

    def tell(self, tally: "Tally") -> None:
        """Write a line."""
        if not tally.frame_sets:
            note(f"{self._images}; no frame set yet, the kernels may still be compiling")
            return
        people = counted_people(len(tally.people))
        note(f"{self._images}, {people} so far{fusion_time(tally.fusion_ms())}")


def _draw_paths(checked: "CheckedSite", summary: "RunSummary") -> None:
    from trecsim.errors import SetupError
    from trecsim.lab.plots.paths_plot import plot_paths
    from trecsim.store.tracks import read_tracks

    tracks, picture = read_tracks(summary.out), summary.out / "paths.png"
    last_s = checked.file.site.output.paths_s
    try:
        plot_paths(tracks, checked.rig, picture, title=summary.site, last_s=last_s)
    except SetupError as error:  # the picture is an extra, the tracks are not
        note(f"no picture of the paths: {error}")


def _facts(summary: "RunSummary") -> dict[str, object]:
    from dataclasses import asdict

    return asdict(summary)


def _told(summary: "RunSummary") -> str:
    gap = ""
    if summary.gaps_s:
        before_s, after_s = summary.gaps_s[-1]
        gap = f"; continued at {after_s:.2f} s, {after_s - before_s:.2f} s after what was there"
    return (
        f"{summary.out}: {counted_people(summary.people)} in {summary.frame_sets} frame sets "
        f"of {summary.images} images, {summary.wall_s:.1f} s{fusion_time(summary.fusion_ms)}{gap}"
    )
