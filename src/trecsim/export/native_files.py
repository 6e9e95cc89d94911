"""Our own formats, for motion that was resampled, filled, smoothed or reduced to one person."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from trecsim.export.base import About
from trecsim.export.motions import Motion
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_writing import write_file
from trecsim.store.tracks_csv import CsvWriter
from trecsim.store.tracks_parquet import tables_of
from trecsim.values import Snapshot


def write_csv(motion: Motion, path: Path, about: About) -> None:
    """Write everybody as CSV."""
    with CsvWriter(path, about.skeleton) as writer:
        for snapshot in snapshots_of_motion(motion):
            writer.write(snapshot)


def write_parquet(motion: Motion, path: Path, about: About) -> None:
    """Write everybody as Parquet, without velocities and covariances."""
    info = TracksInfo(details=False, skeleton=about.skeleton)
    write_file(path, tables_of(snapshots_of_motion(motion), info), info)


def snapshots_of_motion(motion: Motion) -> Iterator[Snapshot]:
    """Yield the motion moment by moment; who has no known joint is not in it."""
    if not motion.people:
        return
    there = [one.present for one in motion.people]
    t_s = np.concatenate([one.t_s[kept] for one, kept in zip(motion.people, there, strict=True)])
    who = np.concatenate([np.full(kept.sum(), at) for at, kept in enumerate(there)])
    row = np.concatenate([np.flatnonzero(kept) for kept in there])
    order = np.lexsort((who, t_s))
    starts = np.flatnonzero(np.diff(t_s[order])) + 1
    for moment in np.split(order, starts):
        people = [(motion.people[who[at]], int(row[at])) for at in moment]
        sigma_m = np.array([one.sigma_m[at] for one, at in people], np.float64)
        yield Snapshot(
            float(t_s[moment[0]]),
            np.array([one.person for one, _ in people], np.int64),
            np.array([one.xyz_m[at] for one, at in people], np.float64),
            (sigma_m**2)[..., None, None] * np.eye(3),
            np.array([one.support[at] for one, at in people], np.int64),
        )
