"""What is doubtful about places and rules of a site, given where its cameras look.

A place that no camera sees, and a zone that is smaller than the uncertainty there, make rules that
can never fire; nothing else would tell.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.fusion.settings import FusionSettings
from trecsim.geometry import Rig
from trecsim.geometry.view_coverage import in_view, located
from trecsim.safety.polygons import Polygon
from trecsim.sites.places import EdgeTable, LineTable, ZoneTable
from trecsim.sites.ruled import Ruled
from trecsim.toml_models.lines import KeyPath

ANKLE_M = 0.1
"""Floor points follow from the ankles, which are about so high [m]."""
_ALONG = 24  # sample points along the longer side of a zone, and along each part of a line
_FEW = 0.5  # of a zone seen by two cameras


class Remark(NamedTuple):
    """Something doubtful.

    Attributes
    ----------
    at
        The keys that lead to it.
    text
        What is doubtful, and what to do.
    """

    at: KeyPath
    text: str


def place_remarks(site: Ruled, rig: Rig, settings: FusionSettings) -> Iterator[Remark]:
    """Yield what is doubtful about the zones, lines, edges and rules of a site.

    Parameters
    ----------
    site
        The site file.
    rig
        Its cameras.
    settings
        How people are followed; the noise of key points is in them.
    """
    for name, zone in site.zones.items():
        yield from _zone_remarks(site, rig, settings, name, zone)
    for kind, tables in (("lines", site.lines), ("edges", site.edges)):
        for name, table in tables.items():
            if not in_view(rig, _raised(_points_on(table))).any():
                yield Remark((kind, name), _UNSEEN)


_UNSEEN = "No camera sees any of it, so nothing is noticed here. Move it, or add a camera."


def _zone_remarks(
    site: Ruled, rig: Rig, settings: FusionSettings, name: str, zone: ZoneTable
) -> Iterator[Remark]:
    polygon = Polygon(np.array(zone.polygon_m, dtype=float))
    xy_m = _points_in(polygon)
    xyz_m = _raised(xy_m)
    cameras = in_view(rig, xyz_m).sum(axis=0)
    if not cameras.any():
        yield Remark(("zones", name), _UNSEEN)
        return
    share = float((cameras >= 2).mean())
    if share < _FEW:
        yield Remark(
            ("zones", name),
            f"Two cameras or more see {100 * share:.0f} % of it. Elsewhere positions are less "
            "certain, and people are found later.",
        )
    cov_m2 = _floor_cov_m2(rig, settings, xy_m)
    known = np.isfinite(cov_m2).all(axis=(-2, -1))
    if known.any():
        yield from _too_small(site, name, polygon, xy_m[known], cov_m2[known])


def _too_small(
    site: Ruled,
    name: str,
    polygon: Polygon,
    xy_m: Float64[np.ndarray, "point 2"],
    cov_m2: Float64[np.ndarray, "point 2 2"],
) -> Iterator[Remark]:
    """Yield the rules that can never be sure enough that somebody is in a zone."""
    rules = [
        (number, rule)
        for number, rule in enumerate(site.rules)
        if rule.of_kind.place == "zone" and rule.place == name
    ]
    if not rules:
        return
    inside = polygon.probability(xy_m, cov_m2)
    best = int(inside.argmax())
    most, sigma_m = float(inside[best]), float(np.sqrt(np.trace(cov_m2[best]) / 2.0))
    for number, rule in rules:
        if most < rule.p_on:
            text = (
                f"Too small: positions here are known to ± {100 * sigma_m:.0f} cm, so the rule is "
                f"at most {100 * most:.0f} % certain, and needs {100 * rule.p_on:.0f} %."
            )
            yield Remark(("zones", name), f"{text} Make the zone larger.")
            yield Remark(("rules", number), text)


def _floor_cov_m2(
    rig: Rig, settings: FusionSettings, xy_m: Float64[np.ndarray, "point 2"]
) -> Float64[np.ndarray, "point 2 2"]:
    """Return the covariance of floor points: of the mean of two ankles, seen by all cameras.

    The errors that all cameras share (`common_sigma_m`) do not get less by more cameras.
    """
    each_m2 = located(rig, _raised(xy_m), settings.joint_sigma_m, settings.floor_px)[:, :2, :2]
    floor_m2: Float64[np.ndarray, "point 2 2"] = (
        each_m2 + settings.common_sigma_m**2 * np.eye(2)
    ) / 2.0
    return floor_m2


def _raised(xy_m: Float64[np.ndarray, "point 2"]) -> Float64[np.ndarray, "point 3"]:
    return np.column_stack([xy_m, np.full(len(xy_m), ANKLE_M)])


def _points_in(polygon: Polygon) -> Float64[np.ndarray, "point 2"]:
    """Return points spread over a polygon; of one too thin for the grid, where it is widest."""
    low_m, high_m = polygon.corners_m.min(axis=0), polygon.corners_m.max(axis=0)
    size_m = high_m - low_m
    for density in (1, 4, 16):
        step_m = float(size_m.max()) / (_ALONG * density)
        counts = np.maximum(np.ceil(size_m / step_m).astype(int), 3)
        axes = [low_m[k] + (np.arange(counts[k]) + 0.5) * size_m[k] / counts[k] for k in (0, 1)]
        grid_m = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
        inside: Float64[np.ndarray, "point 2"] = grid_m[polygon.distance_m(grid_m) > 0.0]
        if len(inside):
            return inside
    middle: Float64[np.ndarray, "1 2"] = polygon.corners_m.mean(axis=0)[None]
    return middle


def _points_on(table: LineTable | EdgeTable) -> Float64[np.ndarray, "point 2"]:
    corners: Sequence[tuple[float, float]] = table.points_m
    points_m = np.array(corners, dtype=float)
    shares = np.linspace(0.0, 1.0, _ALONG)[:, None]
    parts = [start + shares * (end - start) for start, end in pairwise(points_m)]
    return np.concatenate(parts)
