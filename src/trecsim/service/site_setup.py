"""The parts of a site as a service, each made from its site file."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from shlex import quote
from typing import Any, cast

from trecsim.assessing import RuleSet, rule_set
from trecsim.extras import needed
from trecsim.feed import Feed
from trecsim.geometry import Rig
from trecsim.safety.signals import SignalSource, recorded
from trecsim.service.event_keeper import EventKeeper
from trecsim.service.fault_event import TYPES
from trecsim.service.fault_watch import FaultEvents, FaultWatch
from trecsim.service.live_feeds import LiveFeeds, subscription_of
from trecsim.service.live_inputs import LiveInputs
from trecsim.service.monitor import Monitor
from trecsim.service.picture_maker import PictureMaker, Watched
from trecsim.service.rig_keeper import RigKeeper
from trecsim.service.rig_repairs import RigRepairs
from trecsim.service.rule_watch import TYPES as RULE_TYPES
from trecsim.service.rule_watch import ends_of
from trecsim.service.timed_estimator import TimedEstimator
from trecsim.site_run import recordings_folder
from trecsim.sites.check import CheckedSite
from trecsim.sites.feed_files import signals_of
from trecsim.sites.site_file import Site
from trecsim.sites.site_reading import SiteFile
from trecsim.sources.base import Source
from trecsim.store.site_store import SiteStore
from trecsim.values import Frame


def rig_keeper(checked: CheckedSite, out: Path | None, *, live: bool) -> RigKeeper:
    """Return who repairs the rig, where the site file wants that."""
    site = checked.file
    given = f" --out {quote(str(out))}" if out is not None else ""
    return RigKeeper(
        checked.rig,
        RigRepairs(out or recordings_folder(site)),
        automatic=live and site.site.repair.automatic,
        revoke_by=f"trecsim calibrate revoke {quote(str(site.path))}{given}",
    )


def site_store(checked: CheckedSite, out: Path | None) -> SiteStore:
    """Open what a live site stores: beside its recordings, or in the directory of this run."""
    retention = checked.file.site.retention.limits()
    return SiteStore(out or recordings_folder(checked.file), retention)


def fault_events(
    checked: CheckedSite,
    store: SiteStore,
    feed: Feed,
    people: Callable[[], list[dict[str, Any]]],
    tell: Callable[[Mapping[str, Any], bool], None],
) -> tuple[EventKeeper, FaultEvents]:
    """Return who keeps events, and who makes them of faults: those that were open go on."""
    open_events = [one.event for one in store.ledger.open_events(TYPES)]
    of_rules = [one.event for one in store.ledger.open_events(RULE_TYPES)]
    keeper = EventKeeper(store.ledger, tell, [*open_events, *of_rules])
    watch = FaultWatch(checked.file.site.name, open_events, people=people)
    return keeper, FaultEvents(watch, keeper.put, lambda: feed.is_read)


def open_episodes(store: SiteStore) -> list[Mapping[str, Any]]:
    """Return the newest event of each episode that is open."""
    return [one.event for one in store.ledger.open_events([*TYPES, *RULE_TYPES])]


def rules_of_file(file: SiteFile, rig: Rig) -> RuleSet:
    """Return the rules of a site file."""
    return rule_set(file.site.name, file.site, rig)


def left_open(checked: CheckedSite, store: SiteStore) -> list[dict[str, Any]]:
    """Return the ends of episodes of rules that were open when the site ran last."""
    open_events = [one.event for one in store.ledger.open_events(RULE_TYPES)]
    return ends_of(checked.file.site.name, open_events)


def live_feeds(site: Site, inputs: LiveInputs | None) -> LiveFeeds | None:
    """Return the feeds of a live site; None where their messages are known from the start."""
    if inputs is None or inputs.signals is not None:
        return None
    if any(one.mqtt is not None for one in site.feeds.values()):
        needed("feeds by MQTT need paho-mqtt", "outputs", "paho.mqtt.client")
    return LiveFeeds(site.feeds, partial(subscription_of, site))


def known_signals(site: Site, inputs: LiveInputs | None) -> SignalSource:
    """Return messages that are known from the start: with recordings those of the whole files."""
    if inputs is not None and inputs.signals is not None:
        return inputs.signals
    return recorded(signals_of(site.feeds))


def feed_of(inputs: LiveInputs, monitor: Monitor, pictures: PictureMaker | None) -> Feed:
    """Return the 2D poses of what a live site reads; the estimator is timed, images are shown."""
    estimator = inputs.estimator
    timed = estimator and TimedEstimator(estimator, monitor.take_estimate)
    if pictures is None:
        return Feed(inputs.sources, timed)
    images = cast(Sequence[Source[Frame]], inputs.sources)
    return Feed([Watched(source, pictures.take) for source in images], timed)
