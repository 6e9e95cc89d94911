"""What is said about cameras that are late, ahead or silent: once each.

Whatever is wrong with the time of a camera's images is told here, as soon as it shows, and nowhere
else; `trecsim.consistency` leaves out the cameras that were told.
"""

import logging
from collections.abc import Iterable

from trecsim.callbacks import Remark
from trecsim.sync.stream_time import StreamTime

logger = logging.getLogger(__name__)

LATE_S = 1.0  # a camera that is later, further ahead or silent for longer than it may is remarked


class StreamRemarks:
    """Makes remarks about cameras; the same about the same camera only once.

    Parameters
    ----------
    remark
        Is told what is wrong with the time of a camera's images.
    silence
        Whether to log that a camera is silent; not where somebody else watches the cameras.

    Attributes
    ----------
    misdated
        Cameras of which was said that their images are late or ahead.
    """

    def __init__(self, remark: Remark = logger.warning, *, silence: bool = True) -> None:
        self.misdated: set[str] = set()
        self._remark, self._tells_silence = remark, silence
        self._silent: set[str] = set()
        self._catching_up: set[str] = set()

    def ahead(self, camera: str, lead_s: float) -> None:
        """Say that a camera's images are not combined with the others'."""
        if camera not in self.misdated:
            self.misdated.add(camera)
            self._remark(
                f"camera {camera!r} is {lead_s:.3g} s ahead of the other cameras, so its images "
                "are not combined with theirs. Check its clock and its time offset"
            )

    def silence(self, cameras: Iterable[str], time: StreamTime[str], delay_s: float) -> None:
        """Say which live cameras have fallen silent; they may deliver `delay_s` late."""
        for camera in cameras:
            heard = time.heard(camera)
            if camera not in self._silent and time.is_silent(heard, delay_s + LATE_S):
                self._silent.add(camera)
                if self._tells_silence:
                    silent_s = time.elapsed_s - heard.heard_s
                    logger.warning("camera %r has delivered no image for %.3g s", camera, silent_s)

    def delivers(self, camera: str, late_s: float | None) -> None:
        """Take in that a camera has delivered; say so if it was silent, or is late.

        Parameters
        ----------
        camera
            The camera.
        late_s
            By how much its image comes after those of the same time were used [s]; None for one in
            time. After a silence, the images that waited in the camera are expected to be late.
        """
        if camera in self._silent:
            self._silent.discard(camera)
            self._catching_up.add(camera)
            if self._tells_silence:
                logger.warning("camera %r delivers images again", camera)
        if late_s is None:
            self._catching_up.discard(camera)
        elif camera not in self._catching_up and camera not in self.misdated:
            self.misdated.add(camera)
            self._remark(
                f"camera {camera!r} delivers {late_s:.3g} s late, after the other cameras' images "
                "of that time were used. Check its connection or, in a file, the order of the "
                "cameras; and its time offset"
            )
