"""How many cameras supported each joint at the times that a lag has not reached yet."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Int64

from trecsim.fusion.lifecycle import Looks
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import SAME_S
from trecsim.values import Snapshot


@dataclass(slots=True)
class SupportHistory:
    """Supports after the last frame sets, oldest first: time, identities and counts."""

    _past: deque[tuple[float, Int64[np.ndarray, " track"], Int64[np.ndarray, "track joint"]]] = (
        field(default_factory=deque)
    )

    def __len__(self) -> int:
        """Return the number of frame sets that are remembered."""
        return len(self._past)

    def note(self, t_s: float, groups: Sequence[Population], looks: Looks) -> None:
        """Remember how many cameras support each joint at `t_s`, by their newest images.

        `groups` holds all tracks that may be reported.
        """
        looking = looks.newest_s > t_s - looks.look_back_s
        ids = np.concatenate([people.id for people in groups])
        last_seen_s = np.concatenate([people.joint_last_seen_s for people in groups])
        supported = (last_seen_s >= looks.newest_s) & looking
        self._past.append((t_s, ids, supported.sum(axis=-1)))

    def at_its_time(self, snapshot: Snapshot) -> Snapshot:
        """Return a snapshot with the supports of its own time; forget those before."""
        while len(self._past) > 1 and self._past[1][0] <= snapshot.t_s + SAME_S:
            self._past.popleft()
        if not self._past or self._past[0][0] > snapshot.t_s + SAME_S:
            return replace(snapshot, support=np.zeros_like(snapshot.support), state=snapshot.state)
        _, ids, counts = self._past[0]
        row_of = {identity: row for row, identity in enumerate(ids.tolist())}
        support = np.zeros_like(snapshot.support)
        for k, identity in enumerate(snapshot.id.tolist()):
            if identity in row_of:
                support[k] = counts[row_of[identity]]
        return replace(snapshot, support=support, state=snapshot.state)
