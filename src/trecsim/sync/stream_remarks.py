"""What is said about cameras that are late, ahead or silent: once each."""

import logging
from collections.abc import Iterable

from trecsim.sync.stream_time import StreamTime

logger = logging.getLogger(__name__)

LATE_S = 1.0  # a camera that is later, further ahead or silent for longer than it may is remarked


class StreamRemarks:
    """Logs remarks about cameras; the same about the same camera only once."""

    def __init__(self) -> None:
        self._remarked: set[str] = set()
        self._silent: set[str] = set()

    def late(self, camera: str, late_s: float) -> None:
        """Say that the other cameras' images of that time have been used."""
        if camera not in self._remarked:
            self._remarked.add(camera)
            logger.warning(
                "camera %r delivers %.3g s late, after the other cameras' images of that time were "
                "used. Check its connection or, in a file, the order of the cameras; and its time "
                "offset",
                camera,
                late_s,
            )

    def ahead(self, camera: str, lead_s: float) -> None:
        """Say that a camera's images are not combined with the others'."""
        if camera not in self._remarked:
            self._remarked.add(camera)
            logger.warning(
                "camera %r is %.3g s ahead of the other cameras, so its images are not combined "
                "with theirs. Check its clock and its time offset",
                camera,
                lead_s,
            )

    def silence(self, cameras: Iterable[str], time: StreamTime[str], delay_s: float) -> None:
        """Say which live cameras have fallen silent; they may deliver `delay_s` late."""
        for camera in cameras:
            heard = time.heard(camera)
            if camera not in self._silent and time.is_silent(heard, delay_s + LATE_S):
                self._silent.add(camera)
                logger.warning(
                    "camera %r has delivered no image for %.3g s",
                    camera,
                    time.elapsed_s - heard.heard_s,
                )

    def delivers(self, camera: str) -> None:
        """Take in that a camera has delivered; say so if it was silent."""
        if camera in self._silent:
            self._silent.discard(camera)
            logger.warning("camera %r delivers images again", camera)
