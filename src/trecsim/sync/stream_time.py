"""Elapsed time of a set of cameras: what "now", "silent" and "ahead" mean.

Time stamps may be wrong; elapsed time must not be. Live, it is the time at which images arrive. In
a recording nothing arrives: there the stamps of cameras that agree tell it. A camera that disagrees
has its own steps from stamp to stamp, of which a jump counts as one usual interval, and they tell
it once no other camera has delivered for a while. So no wrong clock can make time fly.
"""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)

# A camera is silent when it has delivered nothing for this long, or for `USUAL_STEPS` of its usual
# intervals if they are longer [s].
SILENT_S = 0.3
# A step between two stamps of a camera is a jump beyond `USUAL_STEPS` of its usual intervals; while
# they are being learnt, beyond `AGREE_S`.
USUAL_STEPS, LEARN_STEPS = 3.0, 16
# Cameras whose stamps are this close to each other agree; one that does not is believed when the
# others are `SILENT_S` behind on the axis of elapsed time [s].
AGREE_S = 1.0
# A camera runs ahead when its stamp is this much later than the median of the other cameras', or
# `AHEAD_INTERVALS` of its own. Of two cameras, one cannot tell which is wrong, so the limit is
# wider, and only a camera whose stamps have jumped counts as ahead [s].
AHEAD_S, AHEAD_OF_ONE_S = 0.35, 0.5
AHEAD_INTERVALS = 1.5
# Longer steps are pauses or jumps and say nothing about a camera's interval [s].
JUMP_S = 2.0
# The usual interval follows each step by this factor at most, so that single steps change little.
_FOLLOW = 1.1


@dataclass(slots=True)
class CameraTime:
    """What one camera's stamps say.

    Attributes
    ----------
    stamp_s
        Its last stamp [s].
    usual_s
        Its usual interval; 0 while unknown [s].
    steps
        Number of its images.
    own_s
        Its last image on the axis of elapsed time, by its own steps [s].
    heard_s
        Elapsed time when its last image came [s].
    jumped
        Whether its last step was a jump forwards.
    is_ahead
        Whether it was ahead of the other cameras when it was last compared.
    """

    stamp_s: float = -math.inf
    usual_s: float = 0.0
    steps: int = 0
    own_s: float = -math.inf
    heard_s: float = -math.inf
    jumped: bool = False
    is_ahead: bool = False

    @property
    def silent_after_s(self) -> float:
        """How long it may deliver nothing before it counts as silent [s]."""
        return max(SILENT_S, USUAL_STEPS * self.usual_s)

    @property
    def longest_step_s(self) -> float:
        """The longest step that is no jump [s]."""
        return USUAL_STEPS * self.usual_s if self.steps >= LEARN_STEPS else AGREE_S

    def step(self, stamp_s: float) -> float:
        """Take in a stamp; return how much time its step counts for [s]."""
        gap_s, usual_s, longest_s = stamp_s - self.stamp_s, self.usual_s, self.longest_step_s
        self.jumped = gap_s > longest_s
        self.stamp_s = stamp_s
        if usual_s:
            self.usual_s *= _FOLLOW if usual_s < gap_s < JUMP_S else 1.0 / _FOLLOW
        elif 0.0 < gap_s < JUMP_S:
            self.usual_s = gap_s
        known = self.steps >= LEARN_STEPS
        self.steps += 1
        if self.jumped:
            return usual_s if known else 0.0
        return max(gap_s, 0.0)


class StreamTime(Generic[Key]):
    """How much time has passed, and which cameras are silent or ahead.

    Attributes
    ----------
    elapsed_s
        Time since the first image [s].
    """

    # Plain numbers: for a dozen cameras NumPy takes longer to begin than this takes to end.
    def __init__(self) -> None:
        self.elapsed_s = 0.0
        self._cameras: dict[Key, CameraTime] = {}
        self._began_s: float | None = None
        self._newest_s = math.nan  # stamp of the image that last let time pass

    def note(self, camera: Key, stamp_s: float, arrived_s: float | None = None) -> CameraTime:
        """Take in the stamp of an image.

        Parameters
        ----------
        camera
            Who took it.
        stamp_s
            When, by the camera's clock [s].
        arrived_s
            When it arrived, by one steady clock for all cameras [s]; None in a recording.
        """
        one = self._cameras.get(camera)
        if one is None:
            one = self._cameras[camera] = CameraTime()
        longest_s = one.longest_step_s
        step_s = one.step(stamp_s)
        if arrived_s is None:
            self._note_own(one, stamp_s, step_s, longest_s)
        else:
            self.move_on(arrived_s)
            one.own_s = one.heard_s = self.elapsed_s
        return one

    def _note_own(self, one: CameraTime, stamp_s: float, step_s: float, longest_s: float) -> None:
        """Let time pass by the stamps of an image."""
        if math.isnan(self._newest_s):
            self._newest_s = stamp_s
        lead_s = stamp_s - self._newest_s
        agrees = -AGREE_S <= lead_s <= longest_s
        one.own_s = (
            self.elapsed_s + lead_s if agrees else max(one.own_s + step_s, self.elapsed_s - AGREE_S)
        )
        one.heard_s = max(self.elapsed_s, one.own_s)
        if one.own_s >= self.elapsed_s + (0.0 if agrees else SILENT_S):
            self.elapsed_s, self._newest_s = one.own_s, stamp_s

    def move_on(self, arrived_s: float) -> None:
        """Let time pass up to `arrived_s` on the clock of arrivals [s]."""
        if self._began_s is None:
            self._began_s = arrived_s
        self.elapsed_s = max(self.elapsed_s, arrived_s - self._began_s)

    def is_silent(self, camera: CameraTime, delay_s: float = 0.0) -> bool:
        """Tell whether a camera that may deliver `delay_s` late has stopped delivering."""
        return self.elapsed_s - camera.heard_s > camera.silent_after_s + delay_s

    def all_silent(self) -> bool:
        """Tell whether no camera delivers any more."""
        return all(self.is_silent(camera) for camera in self._cameras.values())

    def heard(self, camera: Key) -> CameraTime:
        """Return what is known of a camera; of one that never delivered, nothing."""
        return self._cameras.get(camera) or CameraTime()

    def ahead(
        self,
        cameras: Sequence[Key],
        stamps_s: Sequence[float],
        near_s: float | None = None,
        tolerance_s: float = 0.0,
    ) -> list[int]:
        """Return which of some images are ahead of what the other cameras tell.

        Parameters
        ----------
        cameras, stamps_s
            Camera and time of each image [s].
        near_s
            Cameras whose last stamp is further than `JUMP_S` from this are not compared with [s].
        tolerance_s
            By how much the cameras may differ besides [s].
        """
        alive = [
            (one.stamp_s, key)
            for key, one in self._cameras.items()
            if not self.is_silent(one) and (near_s is None or abs(one.stamp_s - near_s) <= JUMP_S)
        ]
        told_s = [stamp_s for stamp_s, _ in alive]
        # The images themselves may be older, or newer, than what their cameras told last.
        if max(*told_s, *stamps_s, -math.inf) - min(told_s, default=math.inf) <= AHEAD_S:
            for key in cameras:  # nearly always
                self._cameras[key].is_ahead = False
            return []
        views = enumerate(zip(cameras, stamps_s, strict=True))
        return [
            v
            for v, (key, stamp_s) in views
            if self._is_ahead(key, stamp_s - tolerance_s, [told for told, o in alive if o != key])
        ]

    def _is_ahead(self, camera: Key, stamp_s: float, others_s: list[float]) -> bool:
        one = self._cameras[camera]
        if not others_s:
            return False
        limit_s = AHEAD_S if len(others_s) > 1 else AHEAD_OF_ONE_S
        lead_s = stamp_s - sorted(others_s)[len(others_s) // 2]
        ahead = lead_s > max(limit_s, AHEAD_INTERVALS * one.usual_s)
        one.is_ahead = ahead and (len(others_s) > 1 or one.jumped or one.is_ahead)
        return one.is_ahead
