"""The whole way on real video: how well the people of the sample recording are followed.

Needs the sample recording (``trecsim sample``) or, beside the repository, ``shared/data``. Its two
scenes show the same man; in one of them a woman stands in front of him. There is no 3D truth, so
what can be said is who is tracked for how long under how many identities, how far the tracks are
from the detections they came from, and whether the man moves alike in both scenes.

Run: ``python benchmarks/real_video.py [--folder FOLDER]``
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.body_parts import LIMB_JOINTS
from harness.command import alone
from harness.figures import Figures, once
from harness.options import Options, sample_folder
from trecsim.calibration import read_rig
from trecsim.estimators.pool import estimate
from trecsim.fusion import FusionSettings
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17
from trecsim.sync import frame_sets
from trecsim.tracking import Tally, follow
from trecsim.values import Poses2D, Snapshot

SEEN_SCORE = 0.2
NEAR_PX = 150.0


@dataclass(frozen=True)
class Scene:
    """One scene after the whole way: cameras, 2D poses per frame set, snapshots."""

    rig: Rig
    views: list[tuple[Poses2D, ...]]
    snapshots: list[Snapshot]
    fusion_ms: float

    def present(self, person: int) -> np.ndarray:
        """Return at which times the person is there, (time,)."""
        return np.array([person in snapshot.id for snapshot in self.snapshots])

    def xyz_m(self, person: int) -> np.ndarray:
        """Return the person's joints at all times, NaN while absent, (time, joint, 3)."""
        out = np.full((len(self.snapshots), len(COCO17.joints), 3), np.nan)
        for n, snapshot in enumerate(self.snapshots):
            if person in snapshot.id:
                out[n] = snapshot.xyz_m[list(snapshot.id).index(person)]
        return out

    def people(self) -> list[int]:
        """Return all identities, those whom most cameras support first."""
        support: dict[int, float] = {}
        for snapshot in self.snapshots:
            for k, person in enumerate(snapshot.id.tolist()):
                support[person] = support.get(person, 0.0) + snapshot.support[k].mean()
        return sorted(support, key=lambda person: -support[person])

    def reprojection_px(self, person: int) -> list[float]:
        """Return the distance between limb joints and the key points nearest to the person."""
        errors: list[float] = []
        for views, snapshot in zip(self.views, self.snapshots, strict=True):
            if person not in snapshot.id:
                continue
            xyz_m = snapshot.xyz_m[list(snapshot.id).index(person)]
            for view in views:
                errors += nearest_px(view, self.rig[view.camera].project(xyz_m))
        return errors


def nearest_px(view: Poses2D, xy_px: np.ndarray) -> list[float]:
    """Return the distances of limb joints to the detection that lies nearest, if one is near."""
    off = np.linalg.norm(view.xy_px - xy_px, axis=-1)[:, LIMB_JOINTS]
    off[view.score[:, LIMB_JOINTS] < SEEN_SCORE] = np.nan
    known = [row[np.isfinite(row)] for row in off]
    medians = [np.median(row) if len(row) else np.inf for row in known]
    best = int(np.argmin(medians)) if medians else -1
    return known[best].tolist() if medians and medians[best] < NEAR_PX else []


def run(folder: Path, settings: FusionSettings) -> Scene:
    """Estimate and track one scene."""
    rig = read_rig(folder / "Calib.qca.txt")
    videos = {path.stem: path for path in sorted((folder / "videos").glob("*.mp4"))}
    names = dict(zip(sorted(videos), sorted(rig.names), strict=True))
    images = list(estimate({names[stem]: path for stem, path in videos.items()}))
    tally = Tally()
    snapshots = list(follow(images, rig, settings, tally=tally))
    views = [frame_set.views for frame_set in frame_sets(images)]
    return Scene(rig, views, snapshots, tally.fusion_ms()["median"])


def measure(options: Options) -> Figures:
    """Measure who is tracked for how long in real video, and how far from the images."""
    folder = sample_folder(options)
    options.input.update(data="sample recording (4 cameras, 60 fps, 100 frames, two scenes)")
    settings = options.settings()
    multi = run(folder / "MultiPerson", settings)
    options.tell("two actors done")
    single = run(folder / "SinglePerson", settings)
    actors, others = multi.people()[:2], multi.people()[2:]
    man = single.people()[0]
    apart_m = min(
        float(np.nanmedian(np.linalg.norm(multi.xyz_m(actor) - single.xyz_m(man), axis=-1)))
        for actor in actors
    )
    step_s = float(np.median(np.diff([snapshot.t_s for snapshot in multi.snapshots])))
    longest_s = max((multi.present(p).sum() * step_s for p in others), default=0.0)
    errors_px = np.concatenate([multi.reprojection_px(actor) for actor in actors])
    both = float(np.mean([multi.present(actor) for actor in actors]))
    return {
        "two actors": {
            "tracked, share of frame sets": once(both, "", "higher", matters=0.01),
            "median reprojection error": once(float(np.median(errors_px)), "px"),
            "same man in both scenes apart": once(100 * apart_m, "cm", matters=0.2),
        },
        "others": {
            "people": once(len(others), "", matters=0.5),
            "longest": once(longest_s, "s", matters=0.1),
        },
        "fusion": {"median": once(multi.fusion_ms, "ms", watched=False)},
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
