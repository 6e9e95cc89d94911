"""Tracks as one JSON object, a frame a line."""

from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np

from trecsim.export.base import About
from trecsim.export.motions import Motion, PersonMotion

_DIGITS = 5  # a hundredth of a millimetre
_FRAMES_AT_ONCE = 4096


def write_json(motion: Motion, path: Path, about: About) -> None:
    """Write ``{"format", "skeleton", "joints", "rate_hz", "frames": [{"t_s", "people"}]}``."""
    head = msgspec.json.encode(
        {
            "format": "trecsim.tracks/1",
            "skeleton": about.skeleton.name,
            "joints": about.skeleton.joints,
            "rate_hz": motion.rate_hz,
        }
    )
    with path.open("wb") as file:
        file.write(head[:-1] + b',"frames":[')
        separator = b"\n"
        for frame in _frames(motion):
            file.write(separator + msgspec.json.encode(frame))
            separator = b",\n"
        file.write(b"\n]}\n")


def _frames(motion: Motion) -> Iterator[dict[str, object]]:
    """Yield the frames in order of time; a person is in those in which a joint is known."""
    if not motion.people:
        return
    times_s = np.unique(np.concatenate([one.t_s for one in motion.people]))
    for start in range(0, len(times_s), _FRAMES_AT_ONCE):
        some = times_s[start : start + _FRAMES_AT_ONCE]
        people: dict[float, list[dict[str, object]]] = {t_s: [] for t_s in some.tolist()}
        for one in motion.people:
            within = slice(*np.searchsorted(one.t_s, (some[0], np.nextafter(some[-1], np.inf))))
            for t_s, entry in _entries(one.part(within)):
                people[t_s].append(entry)
        for t_s, entries in people.items():
            if entries:
                yield {"t_s": t_s, "people": entries}


def _entries(one: PersonMotion) -> Iterator[tuple[float, dict[str, object]]]:
    there = one.present
    rows = zip(
        one.t_s[there].tolist(),
        np.round(one.xyz_m[there].astype(np.float64), _DIGITS).tolist(),
        np.round(one.sigma_m[there].astype(np.float64), _DIGITS).tolist(),
        one.support[there].tolist(),
        strict=True,
    )
    for t_s, xyz_m, sigma_m, support in rows:
        yield t_s, {"person": one.person, "xyz_m": xyz_m, "sigma_m": sigma_m, "support": support}
