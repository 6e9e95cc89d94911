"""The one object that watches whether poses and rig fit, and tells it in remarks."""

import math
from dataclasses import dataclass, field

from trecsim.consistency import nobody, pixels, spans
from trecsim.consistency.thresholds import Thresholds
from trecsim.geometry import Rig
from trecsim.values import FrameSet, Poses2D, Snapshot

_GOLDEN = 0.618033988749895  # varies the spacing, lest a slower camera be missed every time


@dataclass(slots=True)
class Consistency:
    """Watch a run; tell once per cause what cannot be right.

    Attributes
    ----------
    rig
        The cameras.
    limit
        When something is remarked.

    Examples
    --------
    ::

        watch = Consistency(rig)
        for frame_set in frame_sets(poses):
            for remark in watch.observe(frame_set, tracker.step(frame_set)):
                print(remark)
        for remark in watch.end():
            print(remark)
    """

    rig: Rig
    limit: Thresholds = field(default_factory=Thresholds)
    _spans: dict[str, spans.Span] = field(init=False)
    _extents: dict[str, pixels.Extent] = field(init=False)
    _views: list[Poses2D] = field(default_factory=list, init=False)
    _samples: int = field(default=0, init=False)
    _sampled_s: float = field(default=-math.inf, init=False)
    _frame_sets: int = field(default=0, init=False)
    _together: int = field(default=0, init=False)
    _anybody: bool = field(default=False, init=False)
    _said: set[str] = field(default_factory=set, init=False)

    def __post_init__(self) -> None:
        self._spans = {name: spans.Span() for name in self.rig.names}
        self._extents = {name: pixels.Extent() for name in self.rig.names}

    def observe(self, frame_set: FrameSet, snapshot: Snapshot) -> list[str]:
        """Take in a frame set and the people after it; return what is to be said by now."""
        with_people = 0
        for view in frame_set.views:
            count = len(view.xy_px)
            self._spans[view.camera].add(view.t_s, count)
            with_people += count > 0
        self._frame_sets += 1
        self._together += with_people > 1
        self._anybody = self._anybody or len(snapshot.id) > 0
        if not self._due(frame_set.t_s):
            return []
        self._views.extend(frame_set.views)
        return self._examine() if self._samples % self.limit.batch == 0 else []

    def end(self) -> list[str]:
        """Return what remains to be said at the end of a run."""
        found = self._examine()
        delivered = {name: span for name, span in self._spans.items() if span.images}
        found += self._new("apart", spans.apart(delivered, self.limit.fewest_images))
        if not self._anybody and not self._said:
            found.append(nobody.why(delivered, self.rig, self._frame_sets, self._together))
        return found

    def _due(self, t_s: float) -> bool:
        """Tell whether a frame set is to be sampled, and count it."""
        limit, late = self.limit, max(0, self._samples - self.limit.settle)
        spacing_s = min(limit.spacing_s * limit.spacing_growth**late, limit.longest_spacing_s)
        spacing_s *= 0.75 + 0.5 * (self._samples * _GOLDEN % 1.0)
        if 0.0 <= t_s - self._sampled_s < spacing_s:
            return False
        self._samples += 1
        self._sampled_s = t_s
        return True

    def _examine(self) -> list[str]:
        """Examine what has been sampled since the last time."""
        pixels.measure(self._extents, self._views, self.rig, self.limit)
        self._views.clear()
        said = pixels.no_pixels(self._extents, self.rig, self.limit)
        return [text for cause, one in said.items() for text in self._new(cause, one)]

    def _new(self, cause: str, text: str | None) -> list[str]:
        """Return a remark, if there is one and its cause has not been told."""
        if text is None or cause in self._said:
            return []
        self._said.add(cause)
        return [text]
