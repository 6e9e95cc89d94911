"""Made people on exact paths, and rules that judge them: scenes whose truth is known by hand."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from made_people import STANDING_M
from trecsim.assessing import RuleEvents, rule_set
from trecsim.sites.recorded_site import RecordedSite
from trecsim.toml_models import parsed
from trecsim.toml_models.toml_reading import examined
from trecsim.values import Snapshot

FPS = 25.0
PLACES = """
format = "trecsim.site/1"
name = "made"
[zones.room]
polygon_m = [[0.0, -1.0], [4.0, -1.0], [4.0, 1.0], [0.0, 1.0]]
[lines.gate]
points_m = [[0.0, -1.0], [0.0, 1.0]]
[edges.platform]
points_m = [[-10.0, 0.0], [10.0, 0.0]]
[volumes.cart]
size_m = [2.0, 1.0, 1.5]
path_m = [[-10.0, 0.0], [10.0, 0.0]]
path_s = [0.0, 10.0]
"""
Path2D = Callable[[np.ndarray], np.ndarray]
"""Where somebody is, (time, 2) [m]; NaN while nobody is there."""


def lying_m() -> np.ndarray:
    """Return the joints of somebody who lies on the back, (joint, 3) [m]."""
    x, y, z = STANDING_M.T
    return np.stack([z - 0.9, y, 0.15 - x], axis=1)


def line(start: Sequence[float], velocity: Sequence[float]) -> Path2D:
    """Return a straight path from a point at time 0."""
    return lambda t_s: np.array(start) + t_s[:, None] * np.array(velocity)


def through(*points: tuple[float, float, float]) -> Path2D:
    """Return a path through points, each with its time [s], x and y [m]."""
    t, x, y = np.array(points, float).T
    return lambda t_s: np.stack([np.interp(t_s, t, x), np.interp(t_s, t, y)], axis=1)


def there(path: Path2D, from_s: float, to_s: float) -> Path2D:
    """Return a path of somebody who is tracked only for a while."""

    def part(t_s: np.ndarray) -> np.ndarray:
        away = (t_s < from_s) | (t_s >= to_s)
        return np.where(away[:, None], np.nan, path(t_s))

    return part


def bodies_on(path: Path2D, t_s: np.ndarray) -> np.ndarray:
    """Return somebody who stands on a path, (time, joint, 3) [m]."""
    xy_m = path(t_s)
    xyz_m = np.broadcast_to(STANDING_M, (len(t_s), 17, 3)).copy()
    xyz_m[..., :2] += xy_m[:, None, :]
    return xyz_m


def falling(at_m: Sequence[float], from_s: float, fall_s: float, t_s: np.ndarray) -> np.ndarray:
    """Return somebody who goes down within a time, (time, joint, 3) [m]."""
    share = np.clip((t_s - from_s) / fall_s, 0.0, 1.0)[:, None, None] ** 2
    xyz_m = (1.0 - share) * STANDING_M + share * lying_m()
    xyz_m[..., :2] += np.array(at_m)
    return xyz_m


def moments(
    people: Sequence[np.ndarray],
    t_s: np.ndarray,
    *,
    sigma_m: float = 0.001,
    support: int = 3,
    seed: int | None = None,
) -> list[Snapshot]:
    """Return snapshots of people, who are numbered; who is NaN is not there.

    Parameters
    ----------
    people
        Joints of each, (time, joint, 3) [m].
    t_s
        Times [s].
    sigma_m
        Stated uncertainty [m].
    support
        Number of cameras.
    seed
        Of errors of this size; None for none.
    """
    everybody = np.array(people)
    if seed is not None:
        everybody = everybody + np.random.default_rng(seed).normal(0.0, sigma_m, everybody.shape)
    made = []
    for n, time_s in enumerate(t_s):
        ids = np.flatnonzero(np.isfinite(everybody[:, n, 0, 0]))
        shape = (len(ids), 17)
        cov_m2 = np.broadcast_to(sigma_m**2 * np.eye(3), (*shape, 3, 3)).copy()
        made.append(
            Snapshot(float(time_s), ids, everybody[ids, n], cov_m2, np.full(shape, support))
        )
    return made


def times(seconds: float, fps: float = FPS) -> np.ndarray:
    """Return the times of frames, with milliseconds [s]."""
    return np.round(np.arange(round(seconds * fps)) / fps, 3)


def site_with(rules: str, places: str = PLACES) -> RecordedSite:
    """Return a site with rules."""
    site, faults = examined(RecordedSite, parsed(Path("site.toml"), places + rules, "site file"))
    assert site is not None, faults
    return site


def events_of(
    rules: str, snapshots: Sequence[Snapshot], *, start_s: float = 0.0, places: str = PLACES
) -> list[dict[str, Any]]:
    """Return the events of snapshots."""
    site = site_with(rules, places)
    engine = RuleEvents(rule_set(site.name, site, None, start_s))
    return [event for snapshot in snapshots for event in engine.step(snapshot)]


def told(events: Sequence[dict[str, Any]], *keys: str) -> list[tuple[Any, ...]]:
    """Return some keys of the data of events."""
    return [tuple(event["data"].get(key) for key in keys) for event in events]
