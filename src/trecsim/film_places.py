"""What belongs to tracks and is shown with them: rig, videos, zones, events, forecasts."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from trecsim.calibration import read_rig
from trecsim.errors import InputError
from trecsim.films.filming import FilmInput
from trecsim.sites.recorded_site import read_without_rig
from trecsim.sites.site_reading import read_site
from trecsim.store.names import RIG


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
        A site file: its rig, videos, zones, lines and edges.
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
    found = {"videos": dict(videos or {})}
    zones: dict[str, np.ndarray] = {}
    lines: dict[str, np.ndarray] = {}
    if site is not None:
        ruled = read_without_rig(site)
        zones = {name: np.array(zone.polygon_m, float) for name, zone in ruled.zones.items()}
        lines = {name: np.array(line.points_m, float) for name, line in ruled.lines.items()}
        lines |= {name: np.array(edge.points_m, float) for name, edge in ruled.edges.items()}
    cameras = None
    rig = rig or _beside(folder, RIG)
    if rig is not None:
        cameras = read_rig(rig)
    if site is not None and (cameras is None or not found["videos"]):
        full = read_site(site).site
        cameras = cameras or full.rig.read(lambda remark: None)
        recorded = {name: one.video for name, one in full.sources.items() if one.video}
        found["videos"] = found["videos"] or recorded
    for name, path in found["videos"].items():
        if not path.is_file():
            raise InputError(f"video of {name}: there is no file {path}")
    return FilmInput(
        cameras,
        found["videos"],
        zones,
        lines,
        events or _beside(folder, "events.jsonl"),
        forecasts or _beside(folder, "forecast.jsonl"),
    )


def _beside(folder: Path, name: str) -> Path | None:
    return folder / name if (folder / name).is_file() else None
