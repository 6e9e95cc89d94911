"""What belongs to tracks and is shown with them: rig, videos, zones, events, forecasts."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from trecsim.calibration import read_rig
from trecsim.errors import InputError
from trecsim.films.film_settings import FilmInput
from trecsim.geometry import Rig
from trecsim.store.recordings import newest_rig


def film_input(
    tracks: Path,
    *,
    rig: Path | None = None,
    site: Path | None = None,
    videos: Mapping[str, Path] | None = None,
    events: Path | None = None,
    forecasts: Path | None = None,
) -> FilmInput:
    """Gather what is shown besides tracks.

    Parameters
    ----------
    tracks
        The tracks; beside them, or in their folder, rig, events and forecasts are looked for.
    rig
        The cameras, in any format that is read.
    site
        A site file: its rig, videos, zones, lines, edges and walls.
    videos
        Video of each camera, by name.
    events, forecasts
        `events.jsonl` and `forecast.jsonl`.

    Raises
    ------
    InputError
        When something given is missing or wrong.
    """
    folder = tracks if tracks.is_dir() else tracks.parent
    rig = rig or _if_file(newest_rig(folder))
    cameras = read_rig(rig) if rig is not None else None
    stage = _of_site(site, cameras) if site is not None else FilmInput(cameras)
    given = dict(videos or {}) or stage.videos
    for name, path in given.items():
        if not path.is_file():
            raise InputError(f"video of {name}: there is no file {path}")
    return replace(
        stage,
        videos=given,
        events=events or _if_file(folder / "events.jsonl"),
        forecasts=forecasts or _if_file(folder / "forecast.jsonl"),
    )


def _of_site(site: Path, cameras: Rig | None) -> FilmInput:
    """Return what a site file names: rig, videos, masks, zones, lines, edges and walls."""
    from trecsim.sites.recorded_site import read_without_rig
    from trecsim.sites.site_reading import read_site

    ruled = read_without_rig(site)
    lines = {
        f"{kind} {name}": np.array(one.points_m, float)
        for kind, tables in (("line", ruled.lines), ("edge", ruled.edges), ("wall", ruled.walls))
        for name, one in tables.items()
    }
    zones = {name: np.array(zone.polygon_m, float) for name, zone in ruled.zones.items()}
    if cameras is None and ruled.rig is not None:
        cameras = ruled.rig.read(lambda remark: None)
    shown = FilmInput(cameras, zones=zones, lines=lines)
    if not ruled.sources:
        return shown
    sources = read_site(site).site.sources
    recorded = {name: one.video for name, one in sources.items() if one.video is not None}
    masks_px = {name: one.mask_px for name, one in sources.items()}
    return replace(shown, videos=recorded, masks_px=masks_px)


def _if_file(path: Path) -> Path | None:
    return path if path.is_file() else None
