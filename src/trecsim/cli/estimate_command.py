"""The command `trecsim estimate`."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from trecsim.cli.models_command import fetch_first
from trecsim.cli.terminal import finish, progress_bar
from trecsim.errors import Error, InputError
from trecsim.redaction import is_address, redacted

if TYPE_CHECKING:
    from trecsim.values import Poses2D

_VIDEOS = {".mp4", ".mov", ".mkv", ".avi", ".ts", ".mts", ".m2ts", ".webm", ".m4v", ".mpg"}

_IMAGES = {".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff"}


def estimate(
    *videos: str,
    out: Path,
    estimator: str = "movenet",
    budget: float | None = None,
    long_side: int | None = None,
    second_look: int | None = None,
    max_people: int | None = None,
    min_person_score: float | None = None,
    min_joint_score: float | None = None,
    precision: str | None = None,
    device: str | None = None,
    threads: int | None = None,
    json: bool = False,
) -> None:
    """Estimate 2D poses in videos.

    Several videos are processed at once. After Ctrl-C or an error, the results so far are kept
    beside the output under a name that ends with `.partial`.

    Parameters
    ----------
    videos
        Videos, one per camera, or directories of videos. The name of a camera is the file name
        without its suffix, or NAME in NAME=VIDEO.
    out
        The file to write, `*.poses.jsonl`.
    estimator
        `movenet`, `onnx:FILE`, `rtmlib:rtmo-m`, or the name of an installed plug-in.
    budget
        Share of the work of looking at every image, above 0 to 1. Images of all cameras are looked
        at together, as often as it allows; the others have no line. With `track --lag-s 0.1` or
        more, an eighth of 60 images per second loses little.
    long_side
        Longer side of the image given to the estimator [px]. Larger values find smaller people
        and take more time.
    second_look
        Only movenet: longer side of a second, smaller version of the image [px], which finds
        people who fill the image; 0 turns it off.
    max_people
        Largest number of people in an image.
    min_person_score
        Leave out people with a lower score (0 to 1).
    min_joint_score
        Leave out key points with a lower score (0 to 1).
    precision
        Only movenet: `auto`, or `f32` for identical numbers on every machine.
    device
        Only onnx and rtmlib: `cpu`, `cuda` or another device of the runtime.
    threads
        Processor threads for the estimator (default: all cores).
    json
        Print the summary as one JSON object.
    """
    settings = {
        "long_side": long_side,
        "second_look": second_look,
        "max_people": max_people,
        "min_person_score": min_person_score,
        "min_joint_score": min_joint_score,
        "precision": precision,
        "device": device,
        "threads": threads,
    }
    files = cameras_of(videos)
    if out.suffix != ".jsonl":
        raise InputError(f"--out {out}: expected a name that ends with .poses.jsonl")
    given = {name: value for name, value in settings.items() if value is not None}
    summary = _estimate(files, out, estimator, given, budget, quiet=json)
    text = (
        f"{out}: {summary['images']} images of {len(files)} cameras, "
        f"{summary['people_per_image']:.2f} people in each, {summary['wall_s']:.1f} s"
    )
    finish(summary, json, text)


def _estimate(
    files: dict[str, Path],
    out: Path,
    estimator: str,
    settings: Mapping[str, object],
    budget: float | None,
    *,
    quiet: bool,
) -> dict[str, object]:
    from trecsim.estimators import load
    from trecsim.estimators.pool import estimate_videos, open_videos
    from trecsim.looking.recorded import estimate_within
    from trecsim.store.poses_writer import PosesWriter

    fetch_first(estimator, quiet=quiet)
    model = load(estimator, **settings)
    opened = open_videos(files, model)
    looked_at = estimate_videos if budget is None else partial(estimate_within, share=budget)
    counts = {camera: _Count() for camera in files}
    start_s = perf_counter()
    try:
        with (
            PosesWriter(out, model.skeleton) as writer,
            progress_bar("images", quiet=quiet) as bar,
        ):
            for poses in looked_at(opened, model, progress=bar):
                writer.write(poses)
                counts[poses.camera].add(poses)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"stopped; {_kept(out, counts)}") from None
    except Error as error:
        raise type(error)(f"{error}; {_kept(out, counts)}") from error
    return _summary(out, estimator, counts, perf_counter() - start_s)


class _Count:
    def __init__(self) -> None:
        self.images = 0
        self.people = 0

    def add(self, poses: "Poses2D") -> None:
        self.images += 1
        self.people += len(poses.person_score)


def _summary(
    out: Path, estimator: str, counts: Mapping[str, _Count], wall_s: float
) -> dict[str, object]:
    images = sum(count.images for count in counts.values())
    people = sum(count.people for count in counts.values())
    return {
        "out": out,
        "estimator": estimator,
        "images": images,
        "people_per_image": people / max(images, 1),
        "cameras": {
            camera: {
                "images": count.images,
                "people_per_image": count.people / max(count.images, 1),
            }
            for camera, count in counts.items()
        },
        "wall_s": wall_s,
        "images_per_s": images / wall_s if wall_s > 0 else 0.0,
    }


def _kept(out: Path, counts: Mapping[str, _Count]) -> str:
    from trecsim.store.atomic import partial_path

    images = sum(count.images for count in counts.values())
    return f"{images} images are kept in {partial_path(out)}" if images else "nothing was finished"


def cameras_of(videos: tuple[str, ...]) -> dict[str, Path]:
    """Return the video files by camera, from the arguments.

    Raises
    ------
    InputError
        When there is none, a directory has none, or two have the name of one camera.
    """
    named: dict[str, Path] = {}
    faults: list[str] = []
    for camera, path in [pair for given in videos for pair in _named(given, faults)]:
        if camera in named:
            faults.append(
                f"camera {camera!r} is there twice: {named[camera]} and {path}; give one of them "
                f"another name: NAME={path}"
            )
        named[camera] = path
    if faults:
        raise InputError("\n".join(faults))
    if not named:
        raise InputError("no video is given; expected: trecsim estimate VIDEO... --out FILE")
    return named


def _named(given: str, faults: list[str]) -> list[tuple[str, Path]]:
    path = Path(given).expanduser()
    if path.is_dir():
        found = sorted(file for file in path.iterdir() if file.suffix.lower() in _VIDEOS)
        if not found:
            images = any(file.suffix.lower() in _IMAGES for file in path.iterdir())
            hint = "; sequences of images are not read: make a video of them" if images else ""
            faults.append(f"there is no video in the directory {path}{hint}")
        return [(file.stem, file) for file in found]
    name, equals, rest = given.partition("=")
    if equals and not path.exists() and not is_address(name):  # it may hold a `=` of its own
        if not name.strip() or not rest:
            faults.append(f"{given!r}: expected NAME=VIDEO")
            return []
        return [(name.strip(), Path(rest).expanduser())]
    return [(Path(redacted(given)).stem, path)]
