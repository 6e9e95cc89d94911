"""Where the vehicles of feeds were, from the messages that a recording has kept."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from trecsim.errors import InputError
from trecsim.safety.signals import Feed, Signal, Signals
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.safety.volumes import FedVolume

_ANY_SIZE_M = (1.0, 1.0, 1.0)  # the middle of a vehicle does not depend on it


class KeptVehicles:
    """Follows the vehicles through a part of a recording.

    Messages that are damaged take the vehicles after them, not the people.

    Parameters
    ----------
    folder
        Of the recording.
    volumes
        The volumes of the site that is shown, as `/api/site` has them.
    from_s, to_s
        The part [s].
    """

    def __init__(
        self, folder: Path, volumes: Mapping[str, Any], from_s: float, to_s: float
    ) -> None:
        self._fed = list(_fed(volumes))
        self._signals = Signals([Feed(one.feed) for one in self._fed])
        self._messages = _readable(folder, from_s, to_s) if self._fed else iter(())
        self._next = next(self._messages, None)

    def at(self, t_s: float) -> tuple[PlacedVehicle, ...]:
        """Return where they were at a time [s]; times only grow."""
        while self._next is not None and self._next.taken_s <= t_s:
            self._signals.take([self._next])
            self._next = next(self._messages, None)
        return tuple(one for volume in self._fed for one in volume.placed(self._signals, t_s))


def _fed(volumes: Mapping[str, Any]) -> Iterator[FedVolume]:
    """Yield the volumes with a feed; a recording may be damaged, and its site with it."""
    for name, one in volumes.items() if isinstance(volumes, Mapping) else ():
        feed = one.get("feed") if isinstance(one, Mapping) else None
        if isinstance(feed, str):
            yield FedVolume(name, feed, _ANY_SIZE_M, 0.0)


def _readable(folder: Path, from_s: float, to_s: float) -> Iterator[Signal]:
    from trecsim.sites.feed_files import kept_between

    with suppress(InputError):
        yield from kept_between(folder, from_s, to_s)
