"""The floor paths of a whole recording, to compare forecasts with."""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.forecasting.constants import LONGEST_GAP_S
from trecsim.forecasting.forecasts import Moment


class RecordedPaths:
    """Where everybody was, at any time of a recording.

    Parameters
    ----------
    moments
        Time [s], identities and floor points [m], in order of time.
    """

    def __init__(
        self,
        moments: Iterable[Moment],
    ) -> None:
        times: defaultdict[int, list[float]] = defaultdict(list)
        points: defaultdict[int, list[np.ndarray]] = defaultdict(list)
        for t_s, person, xy_m in moments:
            for one, xy in zip(person.tolist(), xy_m, strict=True):
                if not np.isnan(xy).any():
                    times[one].append(t_s)
                    points[one].append(xy)
        self._paths = {one: (np.array(times[one]), np.array(points[one])) for one in times}

    def at(
        self, person: Int64[np.ndarray, " person"], times_s: Float64[np.ndarray, " time"]
    ) -> Float64[np.ndarray, "person time 2"]:
        """Return where people were at some times [m]; NaN where that was not seen."""
        return np.array([self._of(one, times_s) for one in person.tolist()]).reshape(
            len(person), len(times_s), 2
        )

    def _of(self, person: int, times_s: np.ndarray) -> np.ndarray:
        seen_s, xy_m = self._paths[person]
        after = np.searchsorted(seen_s, times_s - 1e-6)
        inside = after < len(seen_s)
        after = np.minimum(after, len(seen_s) - 1)
        before = np.maximum(after - 1, 0)
        exact = np.abs(seen_s[after] - times_s) <= 1e-6
        span = seen_s[after] - seen_s[before]
        near = (span > 0) & (span <= LONGEST_GAP_S) & (times_s >= seen_s[0])
        share = np.where(exact, 1.0, (times_s - seen_s[before]) / np.where(span > 0, span, 1.0))
        found = xy_m[before] * (1 - share)[:, None] + xy_m[after] * share[:, None]
        return np.where((inside & (near | exact))[:, None], found, np.nan)
