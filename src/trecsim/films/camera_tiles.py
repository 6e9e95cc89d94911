"""The videos of the cameras, with the skeletons where the lens puts them."""

from collections.abc import Generator
from dataclasses import dataclass, field

import numpy as np

from trecsim.films.bodies_drawn import Projected, draw_body, highest, person_colour
from trecsim.films.people_at import PeopleAt, PersonAt
from trecsim.films.strokes import FAINT, INK, Image, Pen, blank, scaled
from trecsim.geometry import Camera
from trecsim.sources import VideoFile, prefetched
from trecsim.values import Frame

_RIM = (12, 14, 16)
_STALE_S = 1.0


@dataclass(slots=True)
class CameraTile:
    """One camera of a film, read along with it.

    Attributes
    ----------
    camera
        Its calibration.
    video
        Its video, decoded at about the size of the tile.
    width, height
        Size of the tile [px].
    """

    camera: Camera
    video: VideoFile
    width: int
    height: int
    _frames: Generator[Frame, None, None] | None = field(default=None, init=False)
    _shown: Frame | None = field(default=None, init=False)
    _next: Frame | None = field(default=None, init=False)

    def draw(self, t_s: float, lookup: PeopleAt) -> Image:
        """Return the tile at one moment, with people where they were when its image was taken."""
        frame = self._frame_at(t_s)
        image_s = self._time_s(frame) if frame is not None else t_s
        if frame is None or abs(image_s - t_s) > _STALE_S:
            image = blank(self.width, self.height, (225, 229, 232))
            Pen(image).text(f"{self.camera.name}: no image", (14, 26), 16, FAINT)
            return image
        image = scaled(frame.image, self.width, self.height)
        pen = Pen(image)
        self._draw_people(pen, lookup.at(image_s))
        pen.text(self.camera.name, (11, 23), 16, INK)
        pen.text(self.camera.name, (10, 22), 16, (255, 255, 255))
        return image

    def close(self) -> None:
        """End reading."""
        if self._frames is not None:
            self._frames.close()

    def _time_s(self, frame: Frame) -> float:
        return float(self.camera.time_s(frame.t_s))

    def _frame_at(self, t_s: float) -> Frame | None:
        """Read on to the image nearest to a moment."""
        if self._frames is None:
            self._frames = prefetched(self.video, 4)
            self._next = next(self._frames, None)
        while self._next is not None:
            nearer = self._shown is None or (
                abs(self._time_s(self._next) - t_s) <= abs(self._time_s(self._shown) - t_s)
            )
            if not nearer:
                break
            self._shown, self._next = self._next, next(self._frames, None)
        return self._shown

    def _draw_people(self, pen: Pen, people: list[PersonAt]) -> None:
        """Draw everybody, the farthest first."""
        if not people:
            return
        xyz_m = np.stack([one.xyz_m for one in people])
        size = np.array([self.width, self.height])
        scale = size / self.camera.size_px
        xy_px = (self.camera.project(xyz_m) + 0.5) * scale - 0.5
        xy_px[~((xy_px > -0.2 * size) & (xy_px < 1.2 * size)).all(axis=-1)] = np.nan
        forward = self.camera.T_cam_world[2]
        depth = np.nanmean(xyz_m @ forward[:3], axis=1) + forward[3]
        px_per_m = self.camera.K[0, 0] * scale[0] / np.maximum(depth, 0.2)
        for at in np.argsort(depth)[::-1].tolist():
            if np.isfinite(xy_px[at]).any():
                self._draw_person(pen, people[at], xy_px[at], float(px_per_m[at]))

    @staticmethod
    def _draw_person(pen: Pen, one: PersonAt, xy_px: Projected, px_per_m: float) -> None:
        draw_body(pen, one, xy_px, px_per_m, _RIM)
        text_px = float(np.clip(0.15 * px_per_m, 12, 20))
        above = highest(xy_px) - [0, 0.15 * px_per_m + 0.8 * text_px]
        pen.label(str(one.person), above, text_px, person_colour(one.person))
