"""Films and pictures of tracks."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trecsim.errors import InputError
from trecsim.films.alerts import Alert, Alerts, open_at, read_alerts, severity_colour
from trecsim.films.camera_tiles import CameraTile
from trecsim.films.film_layout import Layout, layout
from trecsim.films.film_settings import FilmInput, FilmSettings
from trecsim.films.film_times import part_of, times_of
from trecsim.films.film_writer import write_film
from trecsim.films.people_at import Lookup
from trecsim.films.plan2d import Plan2D, px_per_m
from trecsim.films.predicted import Predicted
from trecsim.films.scene3d import Scene3D, eye_on
from trecsim.films.stage import Stage, stage_around
from trecsim.films.strokes import EDGE, FAINT, INK, Image, Pen, blank, opencv
from trecsim.sources import VideoFile, prefetched
from trecsim.store.atomic import atomic_write

PICTURES = (".png", ".jpg", ".jpeg")
FILMS = (".mp4",)
_AHEAD = 3  # images drawn before they are encoded

Progress = Callable[[int, int | None], None]


@dataclass(frozen=True, slots=True)
class Filmed:
    """What was made.

    Attributes
    ----------
    out
        The file.
    frames
        Number of images.
    rate_hz
        Frames per second; NaN for a picture.
    from_s, to_s
        Times of the first and the last image [s].
    people
        Number of people in it.
    cameras
        Names of the cameras whose video is shown.
    """

    out: Path
    frames: int
    rate_hz: float
    from_s: float
    to_s: float
    people: int
    cameras: tuple[str, ...]


def render(
    tracks: Path | str,
    out: Path | str,
    shown: FilmInput | None = None,
    settings: FilmSettings | None = None,
    progress: Progress | None = None,
) -> Filmed:
    """Make a film (`*.mp4`) or a picture (`*.png`, `*.jpg`) of tracks.

    Parameters
    ----------
    tracks
        What :func:`trecsim.read_tracks` reads.
    out
        The file to write; its ending says which of the two.
    shown
        What is shown besides the tracks.
    settings
        How it looks.
    progress
        Called with the number of images done and of all.

    Raises
    ------
    InputError
        When something given is wrong, or nobody is in the tracks.
    SetupError
        When OpenCV or PyAV is missing, or the disk has no room.
    """
    out, shown, settings = Path(out), shown or FilmInput(), settings or FilmSettings()
    ending = out.suffix.lower()
    if ending not in (*FILMS, *PICTURES):
        raise InputError(
            f"{out}: expected {', '.join(FILMS)} for a film or {', '.join(PICTURES)} for a picture"
        )
    if ending in FILMS and settings.at_s is not None:
        raise InputError(
            f"--at-s is the moment of a picture ({', '.join(PICTURES)}); of a film give --from-s "
            "and --to-s"
        )
    opencv()
    lookup = Lookup(part_of(tracks, settings))
    times_s, rate_hz = times_of(lookup, settings, ending in PICTURES)
    with ExitStack() as stack:
        camera = _Projector(lookup, shown, settings, times_s, stack)
        images = camera.images(times_s)
        if ending in PICTURES:
            _write_picture(out, next(images))
        else:
            drawn = stack.enter_context(closing(prefetched(images, _AHEAD)))
            write_film(out, _counted(drawn, len(times_s), progress), rate_hz, camera.size)
    people = {
        one for t_s in times_s[:: max(len(times_s) // 500, 1)] for one in lookup.at(t_s).person
    }
    return Filmed(out, len(times_s), rate_hz, times_s[0], times_s[-1], len(people), camera.cameras)


class _Projector:
    """Puts the images of a film together."""

    def __init__(
        self,
        lookup: Lookup,
        shown: FilmInput,
        settings: FilmSettings,
        times_s: list[float],
        stack: ExitStack,
    ) -> None:
        self.size = (settings.width // 2 * 2, settings.height // 2 * 2)
        self._empty = blank(*self.size)
        self._lookup = lookup
        self._title = settings.title
        self._alerts: list[Alert] = read_alerts(shown.events) if shown.events else []
        self._predicted = Predicted(shown.forecasts)
        probes = [VideoFile(path, name) for name, path in shown.videos.items()]
        aspects = [one.size_px[0] / one.size_px[1] for one in probes]
        floor_m = lookup.floor_m(times_s[0] - settings.trail_s, times_s[-1])
        stage = stage_around(floor_m, shown.rig, shown.zones, shown.lines)
        candidates = [layout(*self.size, aspects, stacked=stacked) for stacked in (False, True)]
        self._layout: Layout = max(candidates, key=lambda one: _worth(stage, one))
        self._tiles = _tiles(shown, probes, self._layout, times_s)
        for tile in self._tiles:
            stack.callback(tile.close)
        scene, plan, trail_s = self._layout.scene, self._layout.plan, settings.trail_s
        self._scene = Scene3D(stage, scene.width, scene.height, lookup, trail_s)
        self._plan = Plan2D(stage, plan.width, plan.height, lookup, trail_s)
        self.cameras = tuple(tile.camera.name for tile in self._tiles)

    def images(self, times_s: list[float]) -> Iterator[Image]:
        """Yield one image per moment."""
        for t_s in times_s:
            yield self._image(t_s)

    def _image(self, t_s: float) -> Image:
        image = self._empty.copy()
        people = self._lookup.at(t_s)
        alerts = open_at(self._alerts, t_s)
        parts = self._layout
        for tile, box in zip(self._tiles, parts.tiles, strict=True):
            tile.draw(image[box.slices], self._lookup)
        self._scene.draw(image[parts.scene.slices], people, t_s, alerts)
        self._plan.draw(image[parts.plan.slices], people, t_s, alerts, self._predicted)
        self._write_line(image, t_s, len(people.person), alerts)
        if self._title:
            Pen(image).text(self._title, (14, parts.scene.top + 34), 24, INK)
        return image

    def _write_line(self, image: Image, t_s: float, people: int, alerts: Alerts) -> None:
        box = self._layout.bar
        pen = Pen(image)
        base = box.top + 0.68 * box.height
        since_s = t_s - self._lookup.motion.t0_s
        counted = "1 person" if people == 1 else f"{people} people"
        pen.text(f"{since_s:.2f} s", (14, base), 16, INK)
        pen.text(counted, (110, base), 16, FAINT)
        left = 220.0
        for alert in alerts.open[:4]:
            pen.disc((left, base - 5), 6, severity_colour(alert.severity) or EDGE)
            pen.text(alert.text, (left + 12, base), 16, INK)
            left += 36 + pen.width_of(alert.text, 16)


def _worth(stage: Stage, parts: Layout) -> float:
    """Return how large people are in a layout, above all in the 3D view."""
    eye = eye_on(stage, parts.scene.width, parts.scene.height)
    middle_m = np.append((stage.low_m + stage.high_m) / 2, 0.0)
    in_scene = float(eye.px_per_m(eye.depth_m(middle_m)))
    return in_scene**2 * px_per_m(stage, parts.plan.width, parts.plan.height)


def _counted(images: Iterator[Image], of: int, progress: Progress | None) -> Iterator[Image]:
    for number, image in enumerate(images, 1):
        yield image
        if progress is not None:
            progress(number, of)


def _tiles(
    shown: FilmInput, probes: list[VideoFile], parts: Layout, times_s: list[float]
) -> list[CameraTile]:
    tiles = []
    for probe, box in zip(probes, parts.tiles, strict=True):
        if shown.rig is None or probe.camera not in shown.rig:
            known = ", ".join(shown.rig.names) if shown.rig is not None else "no rig is given"
            raise InputError(
                f"video {probe.path}: camera {probe.camera!r} is not in the rig ({known}); name it "
                f"as NAME={probe.path.name}"
            )
        size = (box.width, box.height)
        mask_px = shown.masks_px.get(probe.camera, ())
        video = VideoFile(probe.path, probe.camera, decode_size_px=size, threads=1, mask_px=mask_px)
        tiles.append(CameraTile(shown.rig[probe.camera], video, times_s))
    return tiles


def _write_picture(out: Path, image: Image) -> None:
    cv = opencv()
    _, blob = cv.imencode(out.suffix.lower(), image[..., ::-1])
    with atomic_write(out, "wb", private=True) as file:
        file.write(blob.tobytes())
