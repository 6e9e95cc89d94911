"""A site as a service: its page first, then cameras or recordings through the pipeline.

::

    streams ──> run (estimate, sync, fuse, files) ──> monitor ──> pulse ──> page, service manager
                                                ├──────────────────────────> page
                                                └──> rules ──> ledger, page
                                                                 └──> outputs
"""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any

from trecsim.feed import Feed
from trecsim.geometry import Rig
from trecsim.health import Health
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.opening import deliveries
from trecsim.page.link import PageRequest
from trecsim.page.page_process import PageProcess
from trecsim.run_summary import RunSummary
from trecsim.safety.modes import Overrides
from trecsim.service.counting import Counting
from trecsim.service.event_keeper import EventKeeper
from trecsim.service.live_feeds import LiveFeeds
from trecsim.service.live_inputs import LiveInputs
from trecsim.service.live_signals import KeptSignals, PlaceNames
from trecsim.service.monitor import Monitor
from trecsim.service.picture_maker import PictureMaker, jpeg
from trecsim.service.pulse import FaultLog, Pulse
from trecsim.service.reloading import WHILE_RUNNING, Reloading
from trecsim.service.rig_keeper import RigKeeper
from trecsim.service.rig_repairs import keep_rig
from trecsim.service.rule_watch import RuleWatch
from trecsim.service.site_setup import (
    fault_events,
    feed_of,
    known_signals,
    left_open,
    live_feeds,
    open_episodes,
    rig_keeper,
    rules_of_file,
    site_store,
)
from trecsim.service.systemd import Heartbeat, notify
from trecsim.service.viewing import shows_pictures, site_view
from trecsim.sinks import Taken
from trecsim.site_run import run
from trecsim.sites.check import CheckedSite
from trecsim.sites.site_reading import SiteFile
from trecsim.store.names import OVERRIDES, RIG
from trecsim.store.recorder import Recorder
from trecsim.store.recordings import newest_rig
from trecsim.store.site_store import SiteStore
from trecsim.values import Snapshot


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
        self._keeper: EventKeeper | None = None
        self._pictures: PictureMaker | None = None
        self._deliveries: list[Delivery] = []
        self._rules: RuleWatch | None = None
        self._feeds: LiveFeeds | None = None
        self._lock = Lock()  # of what the page shows: a new rig comes in another thread
        self._file: SiteFile | None = None
        self._rig: Rig | None = None
        self._recording: Path | None = None

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
        site = checked.file.site
        feeds = self._feeds = live_feeds(site, inputs)
        self._show(checked.file, checked.rig)
        monitor = Monitor(checked.rig.names, inputs.readings if inputs else (), rig=checked.rig)
        feed = None
        if inputs is not None:
            self._pictures = self._picture_maker(checked)
            feed = feed_of(inputs, monitor, self._pictures)
        signals = KeptSignals(feeds or known_signals(site, inputs), self._named_places)
        rules = self._rules = RuleWatch(
            rules_of_file(checked.file, checked.rig), self._put_event, signals
        )
        counting = Counting(checked.file.site)
        keeper = rig_keeper(checked, out, live=feed is not None)
        self._reloading = Reloading(
            checked.file,
            partial(self._apply, rules, counting),
            WHILE_RUNNING - {"feeds"} if feeds is None else WHILE_RUNNING,
        )
        watchers = monitor.sinks()
        watchers = replace(watchers, snapshots=[*watchers.snapshots, rules, counting])
        watchers = replace(watchers, poses=[*watchers.poses, keeper])
        told: list[Callable[[Health], None]] = [self._reloading, keeper]
        if self._page is not None:
            shown = Taken(partial(_show_people, self._page, rules))
            watchers = replace(watchers, snapshots=[*watchers.snapshots, shown])
            told.append(self._page.health)
            _take_posted(self._page, feeds)

        def judged() -> Health:
            self._take_in(monitor, feed)
            health = monitor.health()
            outputs = {one.name: one.health() for one in self._deliveries}
            judged_rules, counts = rules.health(health.t_s), counting.counts()
            health = keeper.judged(health)
            return replace(health, rules=judged_rules, outputs=outputs, counts=counts)

        def asked() -> bool:
            self._heartbeat.beat()
            return stop()

        def recording(recorder: Recorder) -> None:
            monitor.take_recorder(recorder)
            signals.keep_in(recorder.folder, time.time() if site.feeds else None)
            self._record_in(recorder.folder, checked.rig)

        def drawn(summary: RunSummary) -> None:
            monitor.ended = True
            picture(summary)

        with ExitStack() as ending:
            store = None
            if feed is not None:
                store = ending.enter_context(site_store(checked, out))
                told += self._keep_events(checked, store, feed, monitor, ending)
            if self._pictures is not None:
                ending.enter_context(self._pictures)
            ending.enter_context(Pulse(judged, tuple(told)))
            ending.callback(keeper.close)
            if inputs is not None:
                ending.callback(inputs.close)
            ending.enter_context(feeds or nullcontext())
            summary = run(
                checked,
                out,
                feed=feed,
                watchers=watchers,
                store=store,
                recording=recording,
                rigs=partial(self._new_rig, keeper, monitor),
                stop=asked,
                picture=drawn,
                **options,
            )
            notify("STOPPING=1")
        return summary

    def _keep_events(
        self,
        checked: CheckedSite,
        store: SiteStore,
        feed: Feed,
        monitor: Monitor,
        ending: ExitStack,
    ) -> list[Callable[[Health], None]]:
        """Open what keeps and sends events; return who is told how well the site works."""
        for one in deliveries(checked.file.site, store.ledger, partial(open_episodes, store)):
            self._deliveries.append(ending.enter_context(one))
        self._keeper, faults = fault_events(checked, store, feed, monitor.people, self._tell_event)
        ending.enter_context(self._keeper)
        for event in left_open(checked, store):
            self._keeper.put(event)
        if self._rules is not None:
            self._rules.override(Overrides.of(store.ledger.setting(OVERRIDES)))
        return [FaultLog(), faults]

    def _apply(self, rules: RuleWatch, counting: Counting, file: SiteFile) -> None:
        """Take over what has changed in a site file."""
        assert self._rig is not None
        rules.change(rules_of_file(file, self._rig))  # first: rules ignore feeds they do not know
        if self._feeds is not None:
            self._feeds.change(file.site.feeds)
        counting.change(file.site)
        self._show(file=file)

    def _named_places(self) -> PlaceNames:
        """Return the names of lines and volumes, as messages of feeds should have them."""
        file = self._file
        return ((), ()) if file is None else (file.site.lines, file.site.volumes)

    def _put_event(self, event: dict[str, Any]) -> None:
        """Keep and show an event of a rule; of a recording, only show it."""
        if self._keeper is not None:
            self._keeper.put(event)
        else:
            self._show_event(event, False)

    def _show(self, file: SiteFile | None = None, rig: Rig | None = None) -> None:
        """Show a site on the page, if there is one; None is what was shown last.

        A site whose messages are known from the start takes none at its page.
        """
        with self._lock:
            self._file = self._file if file is None else file
            self._rig = self._rig if rig is None else rig
            if self._page is not None and self._file is not None and self._rig is not None:
                view = site_view(self._file, self._rig)
                self._page.site(view if self._feeds is not None else replace(view, feeds={}))

    def _tell_event(self, event: Mapping[str, Any], kept: bool) -> None:
        """Show an event, and let all outputs look for it."""
        self._show_event(event, kept)
        for one in self._deliveries:
            one.look()

    def _show_event(self, event: Mapping[str, Any], kept: bool) -> None:
        """Show an event on the page, if there is one."""
        if self._page is not None:
            self._page.event(event, kept=kept)

    def _take_in(self, monitor: Monitor, feed: Feed | None) -> None:
        """Take in what others have counted, and what people at the page ask for."""
        if feed is not None:
            monitor.queue_drops = feed.dropped
            monitor.restarts["fusion"] = feed.restarts
        if self._keeper is not None:
            monitor.ledger_fault = self._keeper.fault
        if self._page is not None:
            monitor.restarts["page"] = self._page.restarts
            for request in self._page.requests():
                self._do(request)

    def _do(self, request: PageRequest) -> None:
        """Do what somebody at the page asks for."""
        if request.kind == "reload":
            self.reload()
        elif request.kind == "event" and self._keeper is not None:
            self._keeper.acted(request.body["event"])
        elif request.kind == "mode" and self._rules is not None:
            self._rules.override(Overrides.of(request.body))
        elif request.kind == "picture" and self._pictures is not None:
            self._pictures.look(request.body["camera"])

    def _record_in(self, folder: Path, rig: Rig) -> None:
        """Keep new rigs in this recording; in one that is continued, that of the site file."""
        self._recording = folder
        if newest_rig(folder).name != RIG:
            keep_rig(rig, folder, time.time())

    def _new_rig(self, keeper: RigKeeper, monitor: Monitor) -> Rig | None:
        """Return a rig that is to be used from now on, told to all who compare with it."""
        rig = keeper.new_rig()
        if rig is not None:
            monitor.take_rig(rig)
            self._show(rig=rig)
            if self._recording is not None:
                keep_rig(rig, self._recording, time.time())
        return rig

    def _picture_maker(self, checked: CheckedSite) -> PictureMaker | None:
        """Return who makes pictures of the cameras, where the page shows them."""
        if self._page is None or not shows_pictures(checked.file):
            return None
        return PictureMaker(jpeg, self._page.picture)


def _show_people(page: PageProcess, rules: RuleWatch, snapshot: Snapshot) -> None:
    """Show where people and vehicles are, after the rules have taken the messages of feeds."""
    page.write(snapshot, rules.vehicles(snapshot.t_s))


def _take_posted(page: PageProcess, feeds: LiveFeeds | None) -> None:
    """Let messages that are posted to the page reach the feeds of a live site."""
    if feeds is not None:
        page.feeds_to(feeds.put)
