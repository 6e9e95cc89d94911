"""A site as a service: its page first, then cameras or recordings through the pipeline.

::

    streams ──> run (estimate, sync, fuse, files) ──> monitor ──> pulse ──> page, service manager
                                                └──────────────────────────> page
"""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from trecsim.geometry import Rig
from trecsim.health import Health
from trecsim.page.page_process import PageProcess
from trecsim.pipeline import Feed
from trecsim.run_summary import RunSummary
from trecsim.service.live_inputs import LiveInputs
from trecsim.service.monitor import Monitor
from trecsim.service.pulse import FaultLog, Pulse
from trecsim.service.reloading import Reloading
from trecsim.service.systemd import Heartbeat, notify
from trecsim.service.timed_estimator import TimedEstimator
from trecsim.service.viewing import site_view
from trecsim.site_run import recordings_folder, run
from trecsim.sites.check import CheckedSite
from trecsim.sites.site_reading import SiteFile
from trecsim.store.site_store import SiteStore


class SiteService:
    """Runs a site, and tells everybody who has to know how well it works.

    Parameters
    ----------
    page
        The page, already listening; None for a site without one.
    """

    def __init__(self, page: PageProcess | None = None) -> None:
        self._page = page
        self._heartbeat = Heartbeat()
        self._reloading: Reloading | None = None

    def reload(self) -> None:
        """Read the site file again soon; may be called by a signal."""
        if self._reloading is not None:
            self._reloading.ask()

    def run(
        self,
        checked: CheckedSite,
        out: Path | None = None,
        *,
        inputs: LiveInputs | None = None,
        stop: Callable[[], bool] = lambda: False,
        picture: Callable[[RunSummary], None] = lambda summary: None,
        **options: Any,
    ) -> RunSummary:
        """Run the site until its recordings end, or `stop` says so.

        Parameters
        ----------
        checked
            What `trecsim.sites.check.check_site` returns.
        out, options
            See `trecsim.site_run.run`.
        inputs
            Live cameras; None reads the recordings that the site file names.
        stop
            Asked after each image and about 20 times a second.
        picture
            Draws what came of the run, at its end.
        """
        self._show(checked.file, checked.rig)
        monitor = Monitor(checked.rig.names, inputs.readings if inputs else ())
        feed = _feed(inputs, monitor) if inputs else None
        self._reloading = Reloading(checked.file, lambda file: self._show(file, checked.rig))
        watchers = monitor.sinks()
        told: list[Callable[[Health], None]] = [self._reloading]
        if self._page is not None:
            watchers = replace(watchers, snapshots=[*watchers.snapshots, self._page])
            told.append(self._page.health)
        if feed is not None:
            told.append(FaultLog())

        def judged() -> Health:
            self._take_in(monitor, feed)
            return monitor.health()

        def asked() -> bool:
            self._heartbeat.beat()
            return stop()

        def drawn(summary: RunSummary) -> None:
            monitor.ended = True
            picture(summary)

        with ExitStack() as ending:
            ending.enter_context(Pulse(judged, tuple(told)))
            if inputs is not None:
                ending.callback(inputs.close)
            store = None if feed is None else ending.enter_context(_store(checked, out))
            summary = run(
                checked,
                out,
                feed=feed,
                watchers=watchers,
                store=store,
                recording=monitor.take_recorder,
                stop=asked,
                picture=drawn,
                **options,
            )
            notify("STOPPING=1")
        return summary

    def _show(self, file: SiteFile, rig: Rig) -> None:
        """Show a site on the page, if there is one."""
        if self._page is not None:
            self._page.site(site_view(file, rig))

    def _take_in(self, monitor: Monitor, feed: Feed | None) -> None:
        """Take in what others have counted, and what people at the page ask for."""
        if feed is not None:
            monitor.queue_drops = feed.dropped
            monitor.restarts["fusion"] = feed.restarts
        if self._page is not None:
            monitor.restarts["page"] = self._page.restarts
            if any(request.kind == "reload" for request in self._page.requests()):
                self.reload()


def _store(checked: CheckedSite, out: Path | None) -> SiteStore:
    """Open what a live site stores: beside its recordings, or in the directory of this run."""
    retention = checked.file.site.retention.limits()
    return SiteStore(out or recordings_folder(checked.file), retention)


def _feed(inputs: LiveInputs, monitor: Monitor) -> Feed:
    estimator = inputs.estimator
    timed = estimator and TimedEstimator(estimator, monitor.take_estimate)
    return Feed(inputs.sources, timed)
