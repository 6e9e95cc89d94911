"""Cameras that were moved while a site runs: key points that all lie beside the people."""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64

from trecsim.geometry import Camera, Rig
from trecsim.values import Poses2D, Snapshot

SPACING_S = 0.5  # a camera is looked at so often
WINDOW_S = 6.0  # its displacement is the median over so long,
FEWEST, LEAST_S = 6, 2.4  # of so many people seen over so long at least
OFF_DEG, BACK_DEG = 0.4, 0.2
"""A camera is off from this displacement on, and back below the second. Errors of key points that
last for seconds displace one person by 0.1 to 0.2 degrees."""
AGAIN_S, CHANGED_DEG = 2.0, 0.4  # a displacement that has changed by so much is told again
STEADY, STEADY_DEG = 0.4, 0.3
"""Displacements differ by less than this share of their median, or by less than this [degrees]."""
SAME_S = 0.1  # images and people further apart in time are not compared
OTHERS = 0.5  # the others must be displaced by less than this share, in the median
SPREAD = 0.12  # of a body's size: its joints must be displaced alike
FAR = 0.8  # of a body's size: a detection further away is somebody else
CLEAR = 1.8  # the next person must be so many times further
MOST_PEOPLE = 12


@dataclass(frozen=True, slots=True)
class ViewError:
    """A camera that looks elsewhere than the rig says.

    Attributes
    ----------
    camera
        Its name.
    since_s
        Since when [s].
    right_deg, down_deg
        By how much its key points lie to the right of the people, and below [degrees].
    """

    camera: str
    since_s: float
    right_deg: float
    down_deg: float

    @property
    def turn_deg(self) -> float:
        """By how much the camera looks elsewhere [degrees]."""
        return math.hypot(self.right_deg, self.down_deg)

    def said(self) -> str:
        """Return what is wrong in a few words."""
        return (
            f"camera {self.camera!r} looks {self.turn_deg:.1f} degrees elsewhere than the rig says "
            f"since {self.since_s:.1f} s: it was knocked; the tracking takes that out. Repair the "
            "rig: trecsim calibrate repair"
        )


@dataclass(slots=True)
class _Sights:
    """Displacements of one camera's people in the last seconds."""

    t_s: deque[float] = field(default_factory=deque)
    off_deg: deque[tuple[float, float]] = field(default_factory=deque)
    looked_s: float = -math.inf

    def add(self, t_s: float, off_deg: Iterable[tuple[float, float]]) -> None:
        for one in off_deg:
            self.t_s.append(t_s)
            self.off_deg.append(one)
        while self.t_s and not 0.0 <= t_s - self.t_s[0] <= WINDOW_S:
            self.t_s.popleft()
            self.off_deg.popleft()

    def median_deg(self) -> Float64[np.ndarray, " 2"]:
        """Return the displacement to the right and down.

        NaN where too few people were seen, or it differs between them, as by a clock that is wrong.
        """
        if len(self.t_s) < FEWEST or self.t_s[-1] - self.t_s[0] < LEAST_S:
            return np.full(2, np.nan)
        off_deg = np.array(self.off_deg)
        middle = np.median(off_deg, axis=0)
        if float(np.median(np.hypot(*(off_deg - middle).T))) > max(
            STEADY * float(np.hypot(*middle)), STEADY_DEG
        ):
            return np.full(2, np.nan)
        return np.asarray(middle)


class ViewWatch:
    """Compares what each camera shows with where the tracked people are.

    The people are those whom the other cameras agree on, as the key points of a camera that was
    knocked are outliers to the tracker.

    Parameters
    ----------
    rig
        The cameras.
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._sights = {camera.name: _Sights() for camera in rig}
        self._off: dict[str, ViewError] = {}
        self._told: dict[str, tuple[float, ViewError]] = {}

    @property
    def off(self) -> dict[str, ViewError]:
        """The cameras that look elsewhere than the rig says, by name."""
        return dict(self._off)

    def displaced_deg(self, camera: str) -> float:
        """Return by how much a camera's key points lie beside the people now; NaN if unknown."""
        return float(np.hypot(*self._sights[camera].median_deg()))

    def observe(self, views: Iterable[Poses2D], snapshot: Snapshot) -> list[ViewError]:
        """Take in images and the people of their time; return what is new of cameras that are off.

        Parameters
        ----------
        views
            With times of the common clock.
        snapshot
            Everybody then, or a little earlier.
        """
        looked = False
        for view in views:
            sights = self._sights[view.camera]
            if 0.0 <= view.t_s - sights.looked_s < SPACING_S or not len(view.xy_px):
                continue
            if abs(view.t_s - snapshot.t_s) > SAME_S:
                continue
            sights.looked_s = view.t_s
            sights.add(view.t_s, _displacements(self._rig[view.camera], view, snapshot))
            looked = True
        return self._judge(snapshot.t_s) if looked else []

    def _judge(self, t_s: float) -> list[ViewError]:
        median = {name: one.median_deg() for name, one in self._sights.items()}
        size = {name: float(np.hypot(*one)) for name, one in median.items()}
        for name, (right, down) in median.items():
            others = [s for other, s in size.items() if other != name and math.isfinite(s)]
            before = self._off.get(name)
            if before is None:
                if size[name] > OFF_DEG and _alone(size[name], others):
                    since_s = t_s - WINDOW_S / 2
                    self._off[name] = ViewError(name, since_s, float(right), float(down))
            elif size[name] < BACK_DEG:
                del self._off[name], self._told[name]
            elif math.isfinite(size[name]):
                self._off[name] = replace(before, right_deg=float(right), down_deg=float(down))
        return [one for name, one in self._off.items() if self._is_news(name, t_s)]

    def _is_news(self, name: str, t_s: float) -> bool:
        """Return whether a camera that is off is to be told, and note that it was."""
        one, (told_s, before) = self._off[name], self._told.get(name, (-math.inf, None))
        if before is not None:
            change = math.hypot(one.right_deg - before.right_deg, one.down_deg - before.down_deg)
            if change < CHANGED_DEG or t_s - told_s < AGAIN_S:
                return False
        self._told[name] = (t_s, one)
        return True


def _alone(size_deg: float, others_deg: list[float]) -> bool:
    """Return whether most other cameras are displaced by much less; of two, nobody can say."""
    return len(others_deg) > 1 and float(np.median(others_deg)) < OTHERS * size_deg


def _displacements(camera: Camera, view: Poses2D, snapshot: Snapshot) -> list[tuple[float, float]]:
    """Return by how much detections lie to the right of their person, and below [degrees]."""
    which = np.flatnonzero(snapshot.is_confirmed & (snapshot.support.max(axis=1) > 1))
    which = which[:MOST_PEOPLE]
    if not len(which):
        return []
    ahead_s = view.t_s - snapshot.t_s
    xyz_m = snapshot.xyz_m[which] + ahead_s * np.nan_to_num(snapshot.velocity_mps[which])
    there_px = camera.project(xyz_m)
    # Who is behind the camera has no size; `nanmax` would warn of that.
    size_px = np.fmax.reduce(there_px[..., 1], axis=1) - np.fmin.reduce(there_px[..., 1], axis=1)
    seen = (np.isfinite(there_px[..., 0]).sum(axis=1) >= 8) & (size_px > 20.0)
    if not seen.any():
        return []
    there_px, size_px = there_px[seen], size_px[seen]
    middle_px = np.array([np.median(one[np.isfinite(one[:, 0])], axis=0) for one in there_px])
    focal_px = 0.5 * (camera.K[0, 0] + camera.K[1, 1])
    found = []
    for body_px in view.xy_px[:MOST_PEOPLE]:
        shown = np.isfinite(body_px[:, 0])
        if shown.sum() < 8:
            continue
        far = np.hypot(*(np.median(body_px[shown], axis=0) - middle_px).T) / size_px
        order = np.argsort(far)
        best = int(order[0])
        if far[best] > FAR or (len(far) > 1 and far[order[1]] < CLEAR * far[best]):
            continue
        off_px = (body_px - there_px[best])[shown & np.isfinite(there_px[best, :, 0])]
        if len(off_px) < 8:
            continue
        middle = np.median(off_px, axis=0)
        if float(np.median(np.hypot(*(off_px - middle).T))) > SPREAD * size_px[best]:
            continue
        right, down = np.degrees(middle / focal_px)
        found.append((float(right), float(down)))
    return found
