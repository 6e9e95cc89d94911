"""How often somebody may do something."""

from collections import OrderedDict
from collections.abc import Callable
from time import monotonic

KEYS_KEPT = 10_000  # whoever asked longest ago is forgotten first


class Rates:
    """Counts what each key does: so many at once, and so many a second in the long run.

    Parameters
    ----------
    per_s
        Allowed in the long run [1/s].
    at_once
        Allowed at once.
    clock
        Tells the time [s].

    Examples
    --------
    >>> rates = Rates(1.0, 2.0, clock=lambda: 0.0)
    >>> [rates.allows("10.0.0.2") for _ in range(3)]
    [True, True, False]
    """

    def __init__(
        self, per_s: float, at_once: float, *, clock: Callable[[], float] = monotonic
    ) -> None:
        self._per_s = per_s
        self._at_once = at_once
        self._clock = clock
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def allows(self, key: str, count: float = 1.0) -> bool:
        """Count so many more; return whether they are allowed, all of them or none."""
        now_s = self._clock()
        left, at_s = self._left.pop(key, (self._at_once, now_s))
        left = min(left + (now_s - at_s) * self._per_s, self._at_once)
        allowed = left >= count
        self._left[key] = (left - count if allowed else left, now_s)
        if len(self._left) > KEYS_KEPT:
            self._left.popitem(last=False)
        return allowed
