"""What the page shows of a site."""

import time
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from trecsim.assessing import armed_rules
from trecsim.errors import Error
from trecsim.geometry import Rig
from trecsim.page.page_data import PageData
from trecsim.page.page_process import PageProcess
from trecsim.page.site_address import page_address
from trecsim.page.site_view import SiteView, cameras_of, floor_of
from trecsim.safety.modes import scheduled
from trecsim.safety.schedules import local_time
from trecsim.site_run import recordings_folder
from trecsim.sites.mode_tables import modes_of
from trecsim.sites.rules import zone_of
from trecsim.sites.site_reading import SiteFile, read_draft
from trecsim.toml_models.table import Table


def site_view(file: SiteFile, rig: Rig) -> SiteView:
    """Return what the page shows of a site.

    Parameters
    ----------
    file
        The site file.
    rig
        Its cameras.
    """
    site = file.site
    mode = scheduled(modes_of(site.modes), local_time(time.time(), zone_of(site.timezone)))
    outlines_m = [
        *(zone.polygon_m for zone in site.zones.values()),
        *(line.points_m for line in site.lines.values()),
        *(edge.points_m for edge in site.edges.values()),
        *(wall.points_m for wall in site.walls.values()),
        *(one.polygon_m for one in site.exclusions.values()),
        *(one.points_m for one in site.portals.values()),
    ]
    return SiteView(
        name=site.name,
        timezone=site.timezone,
        version=sha256(file.text.encode()).hexdigest(),
        cameras=cameras_of(rig),
        zones=_tables(site.zones),
        lines=_tables(site.lines),
        edges=_tables(site.edges),
        walls=_tables(site.walls),
        exclusions=_tables(site.exclusions),
        portals=_tables(site.portals),
        volumes=_tables(site.volumes),
        feeds={
            name: {"source": one.source, "most_per_s": one.most_per_s}
            for name, one in site.feeds.items()
        },
        floor_m=floor_of(rig, outlines_m=outlines_m),
        rule_ids=[rule.id for rule in site.rules],
        mode=None if mode is None else mode.name,
        modes={
            name: {"off": one.off, "schedule": one.schedule} for name, one in site.modes.items()
        },
        rules={"armed": armed_rules(site, time.time()), "total": len(site.rules)},
        pictures=shows_pictures(file),
    )


def _tables(tables: Mapping[str, Table]) -> dict[str, dict[str, Any]]:
    return {name: table.model_dump(mode="json") for name, table in tables.items()}


def shows_pictures(file: SiteFile) -> bool:
    """Return whether a site shows pictures of its cameras: it is told to, and has images."""
    table = file.site.page
    return table is not None and table.pictures and bool(file.site.sources)


def page_of_site(path: Path, out: Path | None = None) -> PageProcess | None:
    """Return the page of a site, which listens at once, before anything else is looked at.

    None where the file has no page, or is not right: whoever checks the file tells what is wrong.

    Parameters
    ----------
    path
        The site file.
    out
        Directory of this run, if it is not where the site file says.

    Raises
    ------
    InputError
        The page cannot listen there, or is not protected there.
    SetupError
        Optional packages are missing.
    """
    draft = read_draft(path)
    table = draft.site.page if draft.site is not None else None
    if draft.site is None or table is None:
        return None
    file = SiteFile(path, draft.text, draft.site)
    try:
        rig = file.site.rig.read(_checked_later)
    except Error:
        return None
    return PageProcess(page_address(table), site_view(file, rig), page_data(file, out))


def page_data(file: SiteFile, out: Path | None = None) -> PageData:
    """Return where the page finds the recordings and the ledger of a site."""
    folder = out or recordings_folder(file)
    return PageData(recordings=folder, ledger=folder, site_file=file.path)


def _checked_later(remark: str) -> None:
    """Drop a remark that `check_site` returns."""
