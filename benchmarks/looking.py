"""What perception costs and what it is worth: a fraction of the looks at a recording, and who lies.

The sample recording (``trecsim sample``), four cameras of 60 images a second, its calibration as
delivered.

- *Budgets*: `trecsim.looking.recorded.estimate_within` with a share of the work, beside every image
  looked at twice (``full``), and beside every k-th image (``thinned``) taken from the latter. The
  processor time is that of the whole process, decoding included, without loading the model. Judge:
  the camera that was left out, its key points from the full run; 12 limb joints, at 60 Hz: between
  two frame sets the tracker says where everybody is, as it does live. *Fast*: joints that move by
  more than 2 m/s in the full run.
- *Lying*: the pictures turned by a quarter from frame 25 on, as if everybody had fallen. Found is
  who lies within 40 px of the skeleton that the picture showed upright.

Run: ``python benchmarks/looking.py [--quick]``; ``--quick`` takes one scene and one budget.
"""

import time
from collections.abc import Callable, Iterable, Mapping
from itertools import islice
from pathlib import Path

import numpy as np

from harness.actor_tracks import Actor, laid_beside, reprojected_px
from harness.command import alone
from harness.demo_video import CAMERAS, FPS, SCENES, Recorded, frame_of, recorded
from harness.figures import Figures, once
from harness.options import Options, sample_folder
from trecsim.estimators import load
from trecsim.estimators.movenet import MoveNet
from trecsim.estimators.pool import estimate_videos, open_videos
from trecsim.fusion import FusionSettings, Tracker
from trecsim.looking.live import SelectiveEstimator
from trecsim.looking.recorded import estimate_within
from trecsim.sources import VideoFile
from trecsim.sync import frame_sets
from trecsim.values import Frame, FrameSet, Poses2D, Snapshot

SHARES = {"1/8": 1 / 8, "1/6": 1 / 6, "1/4": 1 / 4}
THINNED = {"every 8th image": 8, "every 6th image": 6}
LAGS_S = {"lag 0.1 s": 0.1, "lag 0.2 s": 0.2}
FIRST_FRAME, LAST_FRAME = 12, 85
FAST_MPS = 2.0
TURNED_FROM, EVERY, FOUND_PX, GOOD_SCORE = 25, 5, 40.0, 0.3

Run = dict[str, tuple[float, list[Poses2D]]]


def measure(options: Options) -> Figures:
    """Measure cost and error of a share of the looks, and who is found lying."""
    folder = sample_folder(options)
    options.input.update(data="sample recording (4 cameras, 60 fps, frames 12-85, two scenes)")
    model = load("movenet", threads=1)
    assert isinstance(model, MoveNet)
    scenes = SCENES[1:] if options.quick else SCENES
    shares = {"1/8": SHARES["1/8"]} if options.quick else SHARES
    out: dict[str, Figures] = {}
    for name in scenes:
        scene, runs = recorded(folder, name), looked_at(folder / name, model, shares)
        options.tell(f"{name}: poses")
        out[name] = of_scene(scene, runs, options.settings())
        options.tell(name)
    out["lying"] = of_lying(folder, scenes, model)
    return out


def looked_at(scene: Path, model: MoveNet, shares: Mapping[str, float]) -> Run:
    """Return processor time [s] and poses by way of looking."""
    files = dict(zip(CAMERAS, sorted((scene / "videos").glob("*.mp4")), strict=True))
    ways: dict[str, Callable[[list[VideoFile]], Iterable[Poses2D]]] = {
        "full": lambda videos: estimate_videos(videos, model),
        **{
            f"budget {text}": lambda videos, share=share: estimate_within(videos, model, share)
            for text, share in shares.items()
        },
    }
    out: Run = {}
    for name, way in ways.items():
        videos, began_s = open_videos(files, model), time.process_time()
        poses = list(way(videos))
        out[name] = time.process_time() - began_s, poses
    full = out["full"][1]
    for name, step in THINNED.items():
        out[name] = float("nan"), [image for image in full if frame_of(image.t_s) % step == 0]
    return out


def of_scene(scene: Recorded, runs: Run, settings: FusionSettings) -> Figures:
    """Return cost and errors of every way of looking at a scene, relative to the full one."""
    out: dict[str, Figures] = {}
    for lag, lag_s in LAGS_S.items():
        usual: dict[str, float] = {}
        for name, (cost_s, poses) in runs.items():
            px, fast = errors(scene, poses, runs["full"][1], settings, lag_s)
            found = {
                "median": float(np.median(px)),
                "p90": float(np.quantile(px, 0.9)),
                "fast joints": float(np.median(px[fast])),
            }
            usual = usual or found
            figures = {
                f"{key} / full": once(value / usual[key], "x", matters=0.02)
                for key, value in found.items()
            }
            figures["median"] = once(found["median"], "px")
            figures["images"] = once(len(poses), "", watched=False)
            if np.isfinite(cost_s):
                share = cost_s / runs["full"][0]
                figures["processor time / full"] = once(share, "", matters=0.02)
            out.setdefault(name, {})[lag] = figures
    return dict(out)


def errors(
    scene: Recorded, poses: list[Poses2D], full: list[Poses2D], settings: FusionSettings,
    lag_s: float,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return the errors in left-out cameras [px], and which are of fast joints."""
    px, fast = [], []
    for left in CAMERAS:
        used = [name for name in CAMERAS if name != left]
        found = tracked(scene, poses, used, settings, lag_s)
        usual = tracked(scene, full, used, settings, lag_s)
        for who, one in found.items():
            speed = speeds_mps(usual[who])
            for moment in np.flatnonzero(one.identity >= 0):
                frame = int(one.frames[moment])
                off = reprojected_px(scene, left, who, frame, one.xyz_m[moment])
                known = np.isfinite(off)
                px.append(off[known])
                fast.append(speed.get(frame, np.zeros(len(off)))[known] > FAST_MPS)
    return np.concatenate(px), np.concatenate(fast)


def tracked(
    scene: Recorded, poses: list[Poses2D], used: list[str], settings: FusionSettings, lag_s: float
) -> dict[str, Actor]:
    """Return where everybody is at every frame, by the cameras `used`."""
    rig, _ = scene.of(tuple(used))
    images = [image for image in poses if image.camera in used]
    tracker = Tracker(rig, settings, lag_s=lag_s)
    snapshots = [tracker.step(at) for at in with_time_passing(list(frame_sets(images)))]
    actors, _ = laid_beside(one_per_frame(snapshots), scene, FIRST_FRAME, LAST_FRAME)
    return actors


def with_time_passing(sets: list[FrameSet]) -> list[FrameSet]:
    """Return frame sets with empty ones at all frames between them."""
    out: list[FrameSet] = []
    for one, following in zip(sets, [*sets[1:], None], strict=True):
        out.append(one)
        until = following.t_s if following else one.t_s
        between = range(round(one.t_s * FPS) + 1, round(until * FPS))
        out += [FrameSet(frame / FPS, ()) for frame in between]
    return out


def one_per_frame(snapshots: Iterable[Snapshot]) -> list[Snapshot]:
    """Return the last snapshot of each frame."""
    return list({frame_of(snapshot.t_s): snapshot for snapshot in snapshots}.values())


def speeds_mps(actor: Actor) -> dict[int, np.ndarray]:
    """Return how fast the joints move in each frame, over four frames."""
    at = {int(f): xyz for f, xyz in zip(actor.frames, actor.xyz_m, strict=True)}
    return {
        frame: np.linalg.norm(at[frame + 2] - at[frame - 2], axis=-1) * FPS / 4.0
        for frame in at
        if frame - 2 in at and frame + 2 in at
    }


def of_lying(folder: Path, scenes: Iterable[str], model: MoveNet) -> Figures:
    """Return who is found in pictures that are turned from some frame on."""
    shown = plain = by_need = 0
    for path in (video for name in scenes for video in sorted((folder / name).rglob("*.mp4"))):
        selective = SelectiveEstimator(model)
        video = VideoFile(path, path.stem, decode_size_px=model.image_limit_px)
        for frame in islice(video, 0, None, EVERY):
            upright = squared(frame)
            if frame.index < TURNED_FROM:
                selective(upright)
                continue
            people = model(upright)
            good = people.xy_px[people.person_score >= GOOD_SCORE]
            lying = Frame(
                frame.camera, frame.index, frame.t_s, np.ascontiguousarray(np.rot90(upright.image))
            )
            turned = turned_px(good, len(upright.image))
            near_px = FOUND_PX * len(upright.image) / max(video.size_px)
            shown += len(good)
            plain += found(turned, model(lying), near_px)
            by_need += found(turned, selective(lying), near_px)
    return {
        "found": {
            "people": once(shown, "", watched=False),
            "usual looks": once(100 * plain / shown, "%", "higher"),
            "looks by need": once(100 * by_need / shown, "%", "higher", matters=1.0),
        }
    }


def squared(frame: Frame) -> Frame:
    """Return an image on a square, so that it has the same size turned."""
    height, width = frame.image.shape[:2]
    side = max(height, width)
    image = np.zeros((side, side, 3), np.uint8)
    top, left = (side - height) // 2, (side - width) // 2
    image[top : top + height, left : left + width] = frame.image
    return Frame(frame.camera, frame.index, frame.t_s, image)


def turned_px(xy_px: np.ndarray, side: int) -> np.ndarray:
    """Return where points lie in a square image turned by a quarter counter-clockwise."""
    return np.stack([xy_px[..., 1], side - 1 - xy_px[..., 0]], axis=-1)


def found(shown: np.ndarray, poses: Poses2D, near_px: float) -> int:
    """Return how many of the people shown were found."""
    return sum(
        any(np.nanmedian(np.linalg.norm(xy - one, axis=-1)) < near_px for xy in poses.xy_px)
        for one in shown
    )


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
