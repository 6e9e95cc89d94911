"""What the page must know of a site to draw it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from trecsim.geometry import Rig

MARGIN_M = 2.0  # of floor around the cameras and zones


@dataclass(frozen=True, slots=True)
class SiteView:
    """What the page must know of a site to draw it; all of it can be JSON.

    Attributes
    ----------
    name, timezone
        As in the site file.
    version
        SHA-256 of the site file, in hexadecimal digits.
    cameras
        `size_px`, `K`, `distortion_model`, `distortion` and `T_cam_world` by name.
    zones, lines, edges, walls, exclusions, portals, volumes
        As in the site file, by name.
    feeds
        How messages of other systems come (`source`: "file", "http" or "mqtt"), and `most_per_s`.
    floor_m
        Extent of the floor to draw: least x, least y, greatest x, greatest y [m].
    rules
        Number of rules in all (`total`) and of those that are armed (`armed`).
    rule_ids
        All rules, by their `id`.
    mode
        The mode that its schedule puts in force; None without modes. What is in force now is in
        `/api/mode`, and in the health as `rules.mode`.
    modes
        Which rules are `off` in each mode, and its `schedule`, by name.
    pictures
        Whether the site file allows pictures of the cameras.
    kind
        "live", or "recording" when one is replayed.
    """

    name: str
    timezone: str = "UTC"
    version: str = ""
    cameras: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    zones: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    lines: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    edges: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    walls: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    exclusions: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    portals: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    volumes: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    feeds: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    floor_m: Sequence[float] = (-5.0, -5.0, 5.0, 5.0)
    rules: Mapping[str, int] = field(default_factory=lambda: {"armed": 0, "total": 0})
    rule_ids: Sequence[str] = ()
    mode: str | None = None
    modes: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    pictures: bool = False
    kind: str = "live"

    def to_json(self) -> dict[str, Any]:
        """Return the body of `/api/site`."""
        site = asdict(self)
        return {"version": site.pop("version"), "site": site}


def cameras_of(rig: Rig) -> dict[str, dict[str, Any]]:
    """Return the cameras of a rig as a site view lists them."""
    return {
        camera.name: {
            "size_px": [int(size) for size in camera.size_px],
            "K": camera.K.tolist(),
            "distortion_model": camera.distortion_model,
            "distortion": np.asarray(camera.distortion).tolist(),
            "T_cam_world": camera.T_cam_world.tolist(),
        }
        for camera in rig.cameras
    }


def floor_of(rig: Rig, *, outlines_m: Sequence[Sequence[Sequence[float]]] = ()) -> list[float]:
    """Return the extent of the floor that holds cameras and outlines, with a margin [m].

    Parameters
    ----------
    rig
        The cameras.
    outlines_m
        Corners of zones, points of lines and edges [m].
    """
    places = [camera.position_m[:2] for camera in rig.cameras]
    corners = [np.asarray(corner, dtype=float)[:2] for outline in outlines_m for corner in outline]
    xy_m = np.array([*places, *corners]) if places or corners else np.zeros((1, 2))
    low, high = xy_m.min(axis=0) - MARGIN_M, xy_m.max(axis=0) + MARGIN_M
    return [round(float(value), 3) for value in (*low, *high)]
