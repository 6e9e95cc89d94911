"""The command `trecsim run`."""

import sys
from functools import partial
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from trecsim.cli.allocation import give_back_often, share_arenas, share_with_arrow
from trecsim.cli.first_run import compile_first, tell_first_run
from trecsim.cli.models_command import fetch_first
from trecsim.cli.stopping import reloading_on_hangup, stopping_in_order
from trecsim.cli.terminal import (
    ProgressBar,
    counted_people,
    finish,
    fusion_time,
    note,
    progress_bar,
)
from trecsim.errors import InputError
from trecsim.extras import has_extra

if TYPE_CHECKING:
    from trecsim.run_summary import RunSummary
    from trecsim.sites.check import CheckedSite
    from trecsim.tracking import Tally


def run(
    site: Path,
    /,
    *,
    out: Path | None = None,
    as_live: bool = False,
    seconds: float | None = None,
    resume: bool = False,
    provisional: bool = False,
    json: bool = False,
) -> None:
    """Run the pipeline of a site file: cameras or recordings in, people in 3D out.

    Writes to one directory: the tracks (`tracks.parquet`), the cameras (`rig.toml`), the time of
    each frame set (`timing.csv`), a summary with all settings (`summary.json`), a picture of the
    paths (`paths.png`, of recordings) and, if the site file asks for them, the 2D poses
    (`poses.jsonl`). `trecsim report` shows all of it. Results so far are kept if the run is
    interrupted; after a crash or a power failure at most the last two seconds are lost. Without a
    terminal the command writes a line of progress once a minute.

    With `[page]` in the site file it serves the live page; its address is the first line on
    stdout. On live cameras it runs until it is told to end, by Ctrl-C or SIGTERM.

    Parameters
    ----------
    site
        The site file. `trecsim site schema` lists its keys. Or the `Config.toml` of a project of
        Pose2Sim, beside which a site file is then written.
    out
        Directory to write to. Without it: a directory named by the time, under `recordings`
        beside the site file or where the site file says.
    as_live
        Play recordings as if they were live cameras: at their own pace, dated from now on, images
        left out where this machine cannot keep up.
    seconds
        End after this time [s].
    resume
        Go on with the recording in the directory `--out`, if there is one: after a crash, or where
        it ended. Images up to its end are left out; people get new identities.
    provisional
        Of recordings, also write people whose track is not confirmed yet; their `state` is
        `provisional`. Live cameras always do.
    json
        Print the summary as one JSON object.
    """
    share_arenas()  # before anything starts threads
    share_with_arrow()
    give_back_often()
    from trecsim.cli.page_line import site_page
    from trecsim.service.live_inputs import live_inputs
    from trecsim.service.site_service import SiteService
    from trecsim.sites.check import check_site
    from trecsim.sites.pose2sim_project import is_project, site_of_project

    if resume and out is None:
        raise InputError("--resume needs the directory of the recording: give --out DIRECTORY")
    if seconds is not None and not seconds > 0.0:
        raise InputError(f"--seconds: expected a time above 0, found {seconds:g}")
    if is_project(site):
        site = site_of_project(site, note)
    with stopping_in_order() as stop, site_page(site, out, json=json) as page:
        checked = check_site(site, as_live=as_live)
        for remark in checked.remarks:
            note(remark)
        if checked.file.site.sources:
            fetch_first(checked.file.site.estimator.name, quiet=json)
        inputs = live_inputs(checked, as_live=as_live)
        if checked.file.site.poses is not None and inputs is None:
            compile_first(quiet=json)
        else:  # compiled while the first images are estimated, or the cameras looked for
            tell_first_run(quiet=json)
        told = json or sys.stderr.isatty()  # a terminal shows a bar; --json shows nothing
        service = SiteService(page)
        reloading_on_hangup(service.reload)
        with progress_bar("images", quiet=json) as bar:
            lines = _Lines(bar)
            summary = service.run(
                checked, out, inputs=inputs, resume=resume, progress=lines.passed, stop=stop,
                seconds=seconds, provisional=provisional,
                tell=_tell_nothing if told else lines.tell,
                picture=partial(_draw_paths, checked) if inputs is None else _draw_nothing,
            )  # fmt: skip
    if summary.ended == "stopped" and inputs is None:
        raise KeyboardInterrupt(f"stopped; {_told(summary)}")
    film = _film_command(site, summary) if inputs is None else ""
    finish(_facts(summary), json, _told(summary) + film)


def _film_command(site: Path, summary: "RunSummary") -> str:
    """Return how to see what was found, where films can be made."""
    if not summary.people or not has_extra("render"):
        return ""
    film = quote(str(summary.out / "film.mp4"))
    return f"\na film: trecsim render {quote(str(summary.out))} {film} --site {quote(str(site))}"


def _draw_nothing(summary: "RunSummary") -> None:
    pass


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
        people = counted_people(tally.people)
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
