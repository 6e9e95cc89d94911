"""What a tracker reports, and what it keeps for that until the lag has passed."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from trecsim.fusion.lifecycle import Looks
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.snapshots import snapshot_of
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.support_history import SupportHistory
from trecsim.fusion.tuning import SAME_S
from trecsim.values import Snapshot


class Reports:
    """Reports the tracks at the time of the newest image minus the lag, dead since or not.

    Parameters
    ----------
    lag_s
        How far behind the newest image [s].
    provisional
        Whether tracks that are not confirmed are reported, too.
    """

    def __init__(self, lag_s: float, provisional: bool) -> None:
        self._lag_s = lag_s
        self._provisional = provisional
        self.forget()

    def __len__(self) -> int:
        """Return the number of groups of dead tracks that the lag has not passed yet."""
        return len(self._ended)

    def forget(self) -> None:
        """Forget all tracks, as time jumps."""
        self._ended: list[tuple[float, KnotGrid, Population]] = []
        self._supports = SupportHistory()

    def keep(
        self, people: Population, which: Bool[np.ndarray, " track"], grid: KnotGrid, t_s: float
    ) -> None:
        """Keep those of the tracks that die at `t_s` until the lag has reached their end."""
        if self._lag_s > 0.0 and which.any():
            self._ended.append((t_s, grid, people.keep(which)))

    def note(self, t_s: float, groups: Sequence[Population], looks: Looks) -> None:
        """Remember how many cameras support all tracks at `t_s`, if there is a lag."""
        if self._lag_s > 0.0:
            self._supports.note(t_s, groups, looks)

    def snapshot(
        self,
        alive: Sequence[tuple[KnotGrid, Population]],
        now_s: float,
        newest_s: float,
        looks: Looks,
        model: Model,
    ) -> Snapshot:
        """Return the tracks that were alive at `now_s` minus the lag.

        Parameters
        ----------
        alive
            Tracks that still are, with the knot grids of their trajectories.
        now_s, newest_s
            The present, and the time of the newest image used [s].
        looks, model
            When the cameras looked, and constants of the run.
        """
        t_s = now_s - self._lag_s
        self._ended = [one for one in self._ended if one[0] > t_s + SAME_S]
        there = [*((grid, people) for _, grid, people in self._ended), *alive]
        snapshot = snapshot_of(there, t_s, newest_s, looks, model, self._provisional)
        return self._supports.at_its_time(snapshot) if self._lag_s > 0.0 else snapshot
