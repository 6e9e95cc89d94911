"""What is doubtful about the feeds of a site, and about their messages."""

from collections.abc import Collection, Iterable, Iterator

from trecsim.safety.signals import Signal
from trecsim.sites.feed_brokers import feed_broker_remarks
from trecsim.sites.feed_files import read_feed
from trecsim.sites.feed_tables import feed_source_remarks
from trecsim.sites.site_file import Site
from trecsim.toml_models.toml_reading import nearest

_LOOKED_AT_BYTES = 2**24  # longer files are not read for a check
_MOST_REMARKS = 10


def feed_remarks(site: Site) -> Iterator[str]:
    """Yield which files of feeds are not there, the unknown places in the others, and the rest."""
    yield from feed_source_remarks(site.feeds, site.page)
    yield from feed_broker_remarks(site.feeds, site.secrets)
    for name, feed in site.feeds.items():
        if feed.file is None:
            continue
        try:
            size = feed.file.stat().st_size
        except OSError as error:
            later = "; a live site waits for it" if site.is_live else ""
            yield f"feeds.{name}.file: {feed.file} cannot be read: {error.strerror}{later}"
            continue
        if size <= _LOOKED_AT_BYTES:
            yield from name_remarks(read_feed(name, feed.file), site.lines, site.volumes)


def name_remarks(
    signals: Iterable[Signal], lines: Collection[str], volumes: Collection[str]
) -> Iterator[str]:
    """Yield which places messages name that a site file does not have: no rule heeds these.

    Parameters
    ----------
    signals
        The messages.
    lines, volumes
        The names in the site file.
    """
    known = {"line": lines, "volume": volumes}
    kinds = {"grant": "line", "closed": "line", "volume": "volume", "gone": "volume"}
    told = sorted({(one.feed, kinds[one.what], one.about) for one in signals if one.what in kinds})
    unknown = [one for one in told if one[2] not in known[one[1]]]
    for feed, kind, name in unknown[:_MOST_REMARKS]:
        hint = nearest(name, known[kind]) if known[kind] else f"it has no [{kind}s.NAME]"
        yield (
            f"feed {feed} tells of {kind} {name!r}, which the site file does not have, and no rule "
            f"heeds these messages; {hint}"
        )
    if len(unknown) > _MOST_REMARKS:
        yield f"feeds tell of {len(unknown) - _MOST_REMARKS} more places that are not there"
