"""How long ago a camera last saw each person."""

import math

import numpy as np

from trecsim.page.link import SnapshotPart
from trecsim.safety.body_states import bodies
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.values import Snapshot


class LastSeen:
    """Remembers when a camera last supported a joint of each person."""

    def __init__(self) -> None:
        self._seen_s: dict[int, float] = {}

    def ages_s(self, snapshot: Snapshot) -> list[float]:
        """Return how long ago each person of a snapshot was last seen [s]; 0 while seen.

        Snapshots come in the order of time. A person who was never seen counts from the first
        snapshot with that person.
        """
        seen = np.any(snapshot.support > 0, axis=1).tolist()
        now: dict[int, float] = {}
        for person, is_seen in zip(snapshot.id.tolist(), seen, strict=True):
            now[person] = snapshot.t_s if is_seen else self._seen_s.get(person, snapshot.t_s)
        self._seen_s = now
        return [max(snapshot.t_s - last_s, 0.0) for last_s in now.values()]


def snapshot_part(
    snapshot: Snapshot,
    seen_s: list[float],
    vehicles: tuple[PlacedVehicle, ...] = (),
    written_s: float = math.nan,
) -> SnapshotPart:
    """Return a snapshot as it goes over the link; see `SnapshotPart`."""
    return SnapshotPart(
        t_s=float(snapshot.t_s),
        id=snapshot.id.astype("int64").tobytes(),
        xyz_m=snapshot.xyz_m.astype("float64").tobytes(),
        sigma_m=snapshot.sigma_m.astype("float64").tobytes(),
        support=snapshot.support.astype("int64").tobytes(),
        state=snapshot.state.tolist(),
        posture=bodies(snapshot).postures.tolist(),
        seen_s=seen_s,
        vehicles=vehicles,
        written_s=written_s,
    )
