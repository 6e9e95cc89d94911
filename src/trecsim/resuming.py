"""Where a recording is continued after a stop or a crash."""

import math
from pathlib import Path

from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.sources.video import Picture
from trecsim.store.recordings import Stored, stored_in
from trecsim.store.rig_digest import rig_sha256
from trecsim.values import Frame, Poses2D


def stored_before(folder: Path, rig: Rig) -> Stored:
    """Return what the recording to continue holds.

    Parameters
    ----------
    folder
        Of the recording.
    rig
        The cameras of the run.

    Raises
    ------
    InputError
        When the recording was made with other cameras.
    """
    stored = stored_in(folder)
    if stored.rig_sha256 not in (None, rig_sha256(rig)):
        raise InputError(
            f"{folder} was recorded with other cameras than {rig.names}, or they have been "
            "calibrated anew since; begin another recording: give another --out"
        )
    return stored


class Later:
    """Tells whether an image is later than the end of the recording that is continued.

    Parameters
    ----------
    rig
        The cameras, whose clocks' offset and drift are added to the images' times.
    last_s
        The last time in the recording [s]; None when it is empty, and every image is wanted.
    """

    def __init__(self, rig: Rig, last_s: float | None) -> None:
        self._rig = rig
        self._last_s = -math.inf if last_s is None else last_s

    def __call__(self, image: Frame | Picture | Poses2D) -> bool:
        """Return whether `image` is later than the end of the recording."""
        if self._last_s == -math.inf:
            return True
        camera = self._rig[image.camera]
        return image.t_s + camera.time_offset_s + camera.drift_s(image.t_s) > self._last_s
