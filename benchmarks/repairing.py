"""What a repair, and a calibration from people alone, make of cameras that do not fit.

The sample recording's calibration is off by 20 to 30 px in two of four cameras. *Repaired*:
``trecsim calibrate repair`` on 1.7 s of one man (SinglePerson). *From people*: ``trecsim calibrate
people`` on the same man and a bystander, intrinsics known, nothing known of poses; and, as a floor,
on the recording that judges (MultiPerson: the same man and a woman, who is rendered).

Judged by what each camera shows and the other three place: labelled key points of limbs, each
triangulated by itself, and corners of a beam that were clicked by hand. *Left-out* is the median
distance, which holds the errors of key points, too (12 to 14 px remain with any cameras); *shift*
is the length of the median difference, which holds only what all of them have in common. Both are
the means over the cameras.

Run: ``python benchmarks/repairing.py``
"""

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from harness.actor_tracks import LAST_FRAME, label
from harness.beam import beam_px
from harness.command import alone
from harness.demo_video import CAMERAS, SCENES, Recorded, recorded
from harness.figures import Figures, leaves, once
from harness.options import Options, sample_folder
from trecsim.geometry import triangulate

if TYPE_CHECKING:
    from trecsim.geometry import Rig

EVERY = 4  # frames; neighbours tell the same
PINNED = ("cam01", "cam03")  # their distance sets the scale, which nothing here depends on

Array = npt.NDArray[np.float64]


def measure(options: Options) -> Figures:
    """Measure cameras as delivered, repaired, and calibrated from people alone."""
    folder = sample_folder(options)
    options.input.update(data="sample recording (4 cameras, 60 fps, two scenes)")
    scenes = {name: recorded(folder, name) for name in SCENES}
    single, multi = (scenes[name] for name in SCENES)
    out: dict[str, Figures] = {}
    made = {
        "as delivered": lambda: single.rig,
        "repaired": lambda: repaired(single),
        "from people": lambda: from_people(single),
        "from people of MultiPerson": lambda: from_people(multi),
    }
    for name, make in made.items():
        began = time.process_time()
        rig = make()
        out[name] = {
            **judged(rig, scenes),
            "processor time": once(time.process_time() - began, "s", watched=False),
        }
        options.tell(name)
    out["repaired / as delivered"] = ratios(out["repaired"], out["as delivered"])
    out["from people / repaired"] = ratios(out["from people"], out["repaired"])
    return dict(out)


def ratios(one: Figures, other: Figures) -> Figures:
    """Return one's error at left-out cameras, the mean over the actors, by the other's."""

    def left_out(figures: Figures, scene: str) -> float:
        return float(np.mean([
            figure.value
            for path, figure in leaves(figures)
            if path[0].startswith(scene) and path[-1] == "left-out"
        ]))  # fmt: skip

    return {scene: once(left_out(one, scene) / left_out(other, scene), "x") for scene in SCENES}


def repaired(scene: Recorded) -> "Rig":
    """Return the delivered rig, repaired."""
    from trecsim.calibrating.people.repairing import repair_rig

    return repair_rig(scene.of(CAMERAS)[1], scene.rig).rig


def from_people(scene: Recorded) -> "Rig":
    """Return a rig from the intrinsics and the people."""
    from trecsim.calibrating.people.calibrate import calibrate_people
    from trecsim.geometry import Rig

    a, b = (scene.rig[name].position_m for name in PINNED)
    lenses = Rig(tuple(replace(camera, T_cam_world=np.eye(4)) for camera in scene.rig))
    made = calibrate_people(
        scene.of(CAMERAS)[1], lenses, distance=(*PINNED, float(np.linalg.norm(a - b)))
    )
    return made.rig


def judged(rig: "Rig", scenes: dict[str, Recorded]) -> dict[str, Figures]:
    """Return how far what each camera shows is from what the others place."""
    out: dict[str, Figures] = {}
    for name, scene in scenes.items():
        for who in scene.actors:
            off = left_out_px(rig, scene, who)
            each = {c: float(np.median(np.linalg.norm(px, axis=1))) for c, px in off.items()}
            shift = [float(np.linalg.norm(np.median(px, axis=0))) for px in off.values()]
            out[f"{name}, {who}"] = {
                "left-out": once(float(np.mean(list(each.values()))), "px"),
                "shift": once(float(np.mean(shift)), "px"),
                **{c: once(px, "px", watched=False) for c, px in each.items()},
            }
    out["beam"] = {c: once(px, "px") for c, px in beam_px(rig).items()}
    return out


def left_out_px(rig: "Rig", scene: Recorded, who: str) -> dict[str, Array]:
    """Return where the other three cameras place joints, less where each camera shows them [px]."""
    frames = range(0, LAST_FRAME + 1, EVERY)
    shown = np.array(
        [np.concatenate([label(scene, name, who, f) for f in frames]) for name in rig.names]
    )
    ideal = np.stack([camera.undistort(px) for camera, px in zip(rig, shown, strict=True)])
    seen = np.isfinite(ideal).all(axis=(0, 2))
    off = {}
    for number, camera in enumerate(rig):
        others = [n for n in range(len(rig)) if n != number]
        xyz_m, _ = triangulate(rig.P[others], ideal[others][:, seen])
        off[camera.name] = camera.project(xyz_m) - shown[number, seen]
    return off


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
