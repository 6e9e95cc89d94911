"""The videos of the cameras, with the skeletons where the lens puts them."""

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from trecsim.films.bodies_drawn import Bodies
from trecsim.films.people_at import Lookup, PeopleAt
from trecsim.films.strokes import FAINT, INK, WHITE, Image, Pen, fit_into
from trecsim.geometry import Camera
from trecsim.sources import VideoFile, prefetched
from trecsim.sources.video import Picture

_RIM = (12, 14, 16)
_EMPTY = (225, 229, 232)
_STALE_S = 1.0
_AHEAD = 4  # images


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """What a camera shows at one moment.

    Attributes
    ----------
    image_s
        When it was taken [s].
    image
        The image; None if none was taken about then.
    """

    image_s: float
    image: Image | None


@dataclass(slots=True)
class CameraTile:
    """One camera of a film, decoded in a thread of its own.

    Attributes
    ----------
    camera
        Its calibration.
    video
        Its video, decoded at about the size of the tile.
    times_s
        The moments of the film [s], increasing.
    """

    camera: Camera
    video: VideoFile
    times_s: Sequence[float]
    _ahead: Generator[Shot, None, None] | None = field(default=None, init=False)

    def draw(self, image: Image, lookup: Lookup) -> None:
        """Draw the next moment, with people where they were when the camera's image was taken.

        Parameters
        ----------
        image
            What is drawn on, the part of the film's image.
        lookup
            Who is where.
        """
        if self._ahead is None:
            self._ahead = prefetched(self._shots(), _AHEAD)
        shot = next(self._ahead)
        pen = Pen(image)
        if shot.image is None:
            image[...] = _EMPTY
            pen.text(f"{self.camera.name}: no image", (14, 26), 16, FAINT)
            return
        fit_into(shot.image, image)
        self._draw_people(pen, lookup.at(shot.image_s))
        pen.text(self.camera.name, (11, 23), 16, INK)
        pen.text(self.camera.name, (10, 22), 16, WHITE)

    def close(self) -> None:
        """End reading."""
        if self._ahead is not None:
            self._ahead.close()

    def _time_s(self, picture: Picture) -> float:
        return float(self.camera.time_s(picture.t_s))

    def _shots(self) -> Iterator[Shot]:
        """Yield the image nearest to each moment; images between them are not converted."""
        pictures = self.video.pictures(float(self.camera.stamp_s(self.times_s[0])) - _STALE_S)
        shown: Picture | None = None
        image: Image | None = None
        following = next(pictures, None)
        for t_s in self.times_s:
            while following is not None and self._nearer(following, shown, t_s):
                shown, image, following = following, None, next(pictures, None)
            if shown is None or abs(self._time_s(shown) - t_s) > _STALE_S:
                yield Shot(t_s, None)
                continue
            image = shown.frame().image if image is None else image
            yield Shot(self._time_s(shown), image)

    def _nearer(self, picture: Picture, shown: Picture | None, t_s: float) -> bool:
        if shown is None:
            return True
        return abs(self._time_s(picture) - t_s) <= abs(self._time_s(shown) - t_s)

    def _draw_people(self, pen: Pen, people: PeopleAt) -> None:
        if not people.person:
            return
        size = np.array(pen.image.shape[1::-1])
        scale = size / self.camera.size_px
        xy_px = (self.camera.project(people.xyz_m) + 0.5) * scale - 0.5
        xy_px[~((xy_px > -0.2 * size) & (xy_px < 1.2 * size)).all(axis=-1)] = np.nan
        forward = self.camera.T_cam_world[2]
        depth_m = np.nanmean(people.xyz_m @ forward[:3], axis=1) + forward[3]
        px_per_m = self.camera.K[0, 0] * scale[0] / np.maximum(depth_m, 0.2)
        Bodies(people, xy_px, px_per_m).draw(pen, depth_m, _RIM)
