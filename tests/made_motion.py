"""Recordings whose export is read back by other programs."""

from pathlib import Path

import numpy as np

from made_people import STANDING_M
from trecsim.export import Exported, ExportSettings, export_tracks
from trecsim.export.smoothing import Smoothing
from trecsim.store.tracks import tracks_writer
from trecsim.values import Snapshot

RATE_HZ = 25.0


def walking_m(t_s: np.ndarray, person: int = 0) -> np.ndarray:
    """Return somebody who walks along x beside the others and swings arms and legs."""
    xyz_m = np.broadcast_to(STANDING_M, (len(t_s), 17, 3)).copy()
    swing = 0.25 * np.sin(2 * np.pi * 0.9 * t_s)
    xyz_m[..., 0] += 1.2 * t_s[:, None]
    xyz_m[..., 1] += 1.5 * person
    for joints, share in (((15, 10), 1.0), ((16, 9), -1.0), ((13, 8), 0.5), ((14, 7), -0.5)):
        for joint in joints:
            xyz_m[:, joint, 0] += share * swing
    return xyz_m.astype(np.float32).astype(np.float64)


def recorded(
    path: Path, people: dict[int, np.ndarray], t_s: np.ndarray, sigma_m: float = 0.02
) -> Path:
    """Write people to a file of tracks; who is NaN in all joints is absent at that time."""
    with tracks_writer(path) as writer:
        for frame, time_s in enumerate(t_s.tolist()):
            there = [who for who, xyz_m in people.items() if np.isfinite(xyz_m[frame]).any()]
            if not there:
                continue
            xyz_m = np.array([people[who][frame] for who in there])
            cov_m2 = np.broadcast_to(sigma_m**2 * np.eye(3), (*xyz_m.shape, 3)).copy()
            support = np.full(xyz_m.shape[:2], 3)
            writer.write(Snapshot(time_s, np.array(there, np.int64), xyz_m, cov_m2, support))
    return path


def two_walkers(
    folder: Path, name: str = "walk.csv"
) -> tuple[Path, np.ndarray, dict[int, np.ndarray]]:
    """Record two people for 4 s; person 7 is away from 1.5 to 2.5 s, the other's nose later."""
    t_s = np.arange(100) / RATE_HZ
    people = {3: walking_m(t_s), 7: walking_m(t_s, 1)}
    people[7][38:63] = np.nan
    people[3][80:90, 0] = np.nan
    return recorded(folder / name, people, t_s), t_s, people


def exported(tracks: Path, out: Path, smoothing: Smoothing | None = None, **settings) -> Exported:
    """Export with some settings."""
    return export_tracks(
        tracks, out, settings=ExportSettings(smoothing=smoothing or Smoothing(), **settings)
    )
