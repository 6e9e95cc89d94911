"""A recording for the rerun viewer; all people of a frame are one batch."""

from pathlib import Path

import numpy as np

from trecsim.export.base import About
from trecsim.export.motions import Motion
from trecsim.export.person_colours import rgb


def write_rerun(motion: Motion, path: Path, about: About) -> None:
    """Write joints and limbs of everybody over time."""
    import rerun as rr

    xyz_m, row, person = _in_order_of_time(motion)
    times_s, counts = np.unique(row, return_counts=True)
    times_s = np.concatenate([times_s, _ends(times_s, motion)])
    order = np.argsort(times_s, kind="stable")
    counts = np.concatenate([counts, np.zeros(len(times_s) - len(counts), np.int64)])[order]
    times_s = times_s[order]
    joints, limbs = xyz_m.shape[1], len(about.skeleton.limbs)
    colour = np.array([rgb(int(one)) for one in person]) * 255
    colours = np.column_stack([colour, np.full(len(colour), 255)]).astype(np.uint8)
    strips = xyz_m[:, np.array(about.skeleton.limbs)]
    stream = rr.RecordingStream("trecsim", recording_id=about.name)
    kept = stream.memory_recording()  # written here: where the disk is full, rerun waits for ever
    stream.log("people", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    index = rr.TimeColumn("time", duration=times_s - motion.t0_s)
    stream.send_columns(
        "people/joints",
        indexes=[index],
        columns=[
            *rr.Points3D.columns(
                positions=xyz_m.reshape(-1, 3), colors=np.repeat(colours, joints, axis=0),
                radii=np.full(len(xyz_m) * joints, 0.025),
            ).partition(counts * joints),
            *rr.AnyValues.columns(person=person).partition(counts),
        ],
    )  # fmt: skip
    stream.send_columns(
        "people/limbs",
        indexes=[index],
        columns=rr.LineStrips3D.columns(
            strips=strips.reshape(-1, 2, 3), colors=np.repeat(colours, limbs, axis=0),
        ).partition(counts * limbs),
    )  # fmt: skip
    path.write_bytes(kept.drain_as_bytes())
    stream.disconnect()


def _in_order_of_time(motion: Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return joints, time and identity of all poses, sorted by time and then by identity."""
    kept = [one.present for one in motion.people]
    t_s = np.concatenate([one.t_s[which] for one, which in zip(motion.people, kept, strict=True)])
    xyz_m = np.concatenate(
        [one.xyz_m[which] for one, which in zip(motion.people, kept, strict=True)]
    )
    person = np.concatenate(
        [np.full(which.sum(), one.person) for one, which in zip(motion.people, kept, strict=True)]
    )
    order = np.lexsort((person, t_s))
    return xyz_m[order], t_s[order], person[order]


def _ends(times_s: np.ndarray, motion: Motion) -> np.ndarray:
    """Return when nobody is there any more: the viewer shows the last frame until then."""
    last = np.append(np.diff(times_s) > motion.longest_step_s, True)
    return np.asarray(times_s[last] + motion.step_s)
