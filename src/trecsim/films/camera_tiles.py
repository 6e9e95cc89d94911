"""The videos of the cameras, with the skeletons where the lens puts them."""

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field

import numpy as np

from trecsim.films.bodies_drawn import draw_body, highest, person_colour
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
        for one in self._far_first(lookup.at(image_s)):
            self._draw_person(pen, one)
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

    def _far_first(self, people: list[PersonAt]) -> Iterator[PersonAt]:
        at_m = self.camera.position_m
        away = [float(np.linalg.norm(np.nanmean(one.xyz_m, axis=0) - at_m)) for one in people]
        for place in np.argsort(away)[::-1]:
            yield people[place]

    def _draw_person(self, pen: Pen, one: PersonAt) -> None:
        size = np.array([self.width, self.height])
        scale = size / self.camera.size_px
        xy_px = (self.camera.project(one.xyz_m) + 0.5) * scale - 0.5
        inside = ((xy_px > -0.2 * size) & (xy_px < 1.2 * size)).all(axis=1)
        xy_px[~inside] = np.nan
        if not inside.any():
            return
        depth = float((self.camera.T_cam_world @ np.append(np.nanmean(one.xyz_m, axis=0), 1.0))[2])
        px_per_m = float(self.camera.K[0, 0] * scale[0]) / max(depth, 0.2)
        draw_body(pen, one, xy_px, px_per_m, _RIM)
        text_px = float(np.clip(0.15 * px_per_m, 12, 20))
        above = highest(xy_px) - [0, 0.15 * px_per_m + 0.8 * text_px]
        pen.label(str(one.person), above, text_px, person_colour(one.person))
