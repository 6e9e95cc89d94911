"""The one object that watches whether poses and rig fit, and tells it in remarks."""

import math
from collections import deque
from collections.abc import Collection
from dataclasses import dataclass, field, replace

from trecsim.consistency import judge, nobody, pixels, spans, told
from trecsim.consistency.camera_evidence import Evidence, weighed
from trecsim.consistency.sights import Moment, moment
from trecsim.consistency.thresholds import Thresholds
from trecsim.consistency.verdict import Verdict
from trecsim.geometry import Rig
from trecsim.values import FrameSet, Poses2D, Snapshot

_GOLDEN = 0.618033988749895  # varies the spacing, lest a slower camera be missed every time
_LONGEST_LAG_S = 11.0  # a sampled frame set waits no longer for the snapshot of its time
_MOST_WAITING = 256
_MOST_REMEMBERED = 128  # batches
_LONGEST_REST = 32  # batches


@dataclass(slots=True)
class Consistency:
    """Watch a run; tell once per cause what cannot be right.

    Frame sets are sampled, and sampled ever more rarely; a batch of them is examined at a time.

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
    _place: dict[str, int] = field(init=False)
    _spans: tuple[spans.Span, ...] = field(init=False)
    _extents: tuple[pixels.Extent, ...] = field(init=False)
    _views: list[Poses2D] = field(default_factory=list, init=False)
    _waiting: deque[FrameSet] = field(default_factory=deque, init=False)
    _recent: deque[Moment] = field(init=False)
    _new: int = field(default=0, init=False)
    _history: deque[Evidence] = field(init=False)
    _samples: int = field(default=0, init=False)
    _sampled_s: float = field(default=-math.inf, init=False)
    _spacing_s: float = field(init=False)
    _frame_sets: int = field(default=0, init=False)
    _together: int = field(default=0, init=False)
    _anybody: bool = field(default=False, init=False)
    _rest: int = field(default=0, init=False)
    _rests: int = field(default=1, init=False)
    _said: set[str] = field(default_factory=set, init=False)
    _wrong: set[int] = field(default_factory=set, init=False)
    _odd: set[int] = field(default_factory=set, init=False)

    def __post_init__(self) -> None:
        self._place = {name: number for number, name in enumerate(self.rig.names)}
        self._spans = tuple(spans.Span() for _ in self.rig)
        self._extents = tuple(pixels.Extent() for _ in self.rig)
        self._spacing_s = self.limit.spacing_s
        self._recent = deque(maxlen=self.limit.recent)
        self._history = deque(maxlen=_MOST_REMEMBERED)

    @property
    def has_spoken(self) -> bool:
        """Whether something was said of cameras that do not agree."""
        return bool(self._said)

    def observe(self, frame_set: FrameSet, snapshot: Snapshot) -> list[str]:
        """Take in a frame set and the people after it; return what is to be said by now."""
        with_people = 0
        for view in frame_set.views:
            count = len(view.xy_px)
            self._spans[self._place[view.camera]].add(view.t_s, count)
            with_people += count > 0
        self._frame_sets += 1
        self._together += with_people > 1
        self._anybody = self._anybody or len(snapshot.id) > 0
        if self._due(frame_set.t_s):
            self._views.extend(frame_set.views)
            if with_people > 1:
                self._waiting.append(frame_set)
        if self._waiting:
            self._keep(snapshot)
        if self._new >= self.limit.batch or len(self._views) >= self.limit.most_views:
            return self._examine(final=False)
        return []

    def end(self, *, complete: bool = True, misdated: Collection[str] = ()) -> list[str]:
        """Return what remains to be said at the end of a run.

        Parameters
        ----------
        complete
            Whether all images came. If an error ended the run, it explains why nobody was found.
        misdated
            Cameras of which is known, and was said, that their images come at wrong times.
        """
        found = self._examine(final=True)
        delivered = {
            name: span
            for name, span in zip(self.rig.names, self._spans, strict=True)
            if span.images
        }
        found += self._clocks(misdated)
        dated = {name: span for name, span in delivered.items() if name not in misdated}
        text = spans.apart(dated, self.limit.fewest_images)
        found += [] if text is None else [text]
        explained = bool(self._said) or text is not None
        if misdated and sum(span.with_people > 0 for span in delivered.values()) > 1:
            explained = True
        if complete and not self._anybody and not explained:
            found.append(nobody.why(delivered, self.rig, self._frame_sets, self._together))
        return found

    def _clocks(self, misdated: Collection[str]) -> list[str]:
        """Return what is odd about the times of cameras that did not agree with the others."""
        known = {c for name, c in self._place.items() if name in misdated}
        hints = {c: told.clock_hint(c, self._spans) for c in sorted(self._odd - known)}
        return [told.clock(self.rig.names[c], hint) for c, hint in hints.items() if hint]

    def _due(self, t_s: float) -> bool:
        """Tell whether a frame set is to be sampled, and count it."""
        varied = 0.75 + 0.5 * (self._samples * _GOLDEN % 1.0)
        if 0.0 <= t_s - self._sampled_s < varied * self._spacing_s:
            return False
        self._samples += 1
        if self._samples > self.limit.settle:
            longer_s = self._spacing_s * self.limit.spacing_growth
            self._spacing_s = min(longer_s, self.limit.longest_spacing_s)
        self._sampled_s = t_s
        return True

    def _keep(self, snapshot: Snapshot) -> None:
        """Keep the frame sets whose time the snapshots have reached."""
        while self._waiting:
            ahead_s = self._waiting[0].t_s - snapshot.t_s
            if 0.0 < ahead_s <= _LONGEST_LAG_S and len(self._waiting) < _MOST_WAITING:
                return
            frame_set = self._waiting.popleft()
            if ahead_s > 0.0:
                continue
            one = self._without_wrong(moment(frame_set, self._place, snapshot, self.limit))
            if len(one.looks) > 1:
                self._recent.append(one)
                self._new += 1

    def _without_wrong(self, one: Moment) -> Moment:
        """Return a moment without the cameras that are known to be wrong."""
        if not self._wrong:
            return one
        return replace(one, looks=tuple(it for it in one.looks if it.cam not in self._wrong))

    def _examine(self, final: bool) -> list[str]:
        """Examine what has been sampled since the last time."""
        pixels.measure(self._extents, self._views, self.rig, self.limit)
        self._views.clear()
        unfit = pixels.no_pixels(self._extents, self.rig, self.limit)
        found = [text for one in unfit if one.sure for text in self._tell(one)]
        unsure = [one for one in unfit if not one.sure]
        if self._new >= (self.limit.least_moments if final else self.limit.batch):
            self._history.append(weighed(list(self._recent)[-self._new :], self.rig, self.limit))
            self._new = 0
            found += self._judge(final, unsure)
        elif final:
            found += self._judge(final, unsure)
        if final or len(self._history) > self.limit.window:
            found += [text for one in unsure for text in self._tell(one)]
        return found

    def _judge(self, final: bool, unfit: list[Verdict]) -> list[str]:
        """Return what is to be said of cameras that do not agree with the others."""
        if not final and len(self._history) < self.limit.window:
            return []
        found: list[str] = []
        while len(self._history) and (verdict := self._verdict(final)) is not None:
            better = [] if verdict.sure else unfit
            new = [text for one in better for text in self._tell(one)] or self._tell(verdict)
            if not new:
                break
            found += new
        return found

    def _verdict(self, final: bool) -> Verdict | None:
        records = judge.Records(
            self.rig, self.limit, tuple(self._history), tuple(self._recent), self._spans, final
        )
        left = [c for c in range(len(self.rig)) if c not in self._wrong]
        suspects = judge.suspicious(records.history, self.limit)
        self._rest = max(0, self._rest - 1)
        if suspects and self._rest and not final:
            suspects = []
        verdict = judge.judged(records, suspects, left)
        if suspects and verdict is None:
            self._rest = self._rests = min(2 * self._rests, _LONGEST_REST)
        return verdict

    def _leave_out(self, wrong: tuple[int, ...]) -> None:
        """Look at the other cameras only from now on, as if these had not been there."""
        self._wrong.update(wrong)
        kept = [self._without_wrong(one) for one in self._recent]
        self._recent.clear()
        self._recent.extend(one for one in kept if len(one.looks) > 1)
        self._history.clear()
        self._new = min(self._new, len(self._recent))
        old, size = list(self._recent)[: len(self._recent) - self._new], self.limit.batch
        for start in range(len(old) % size, len(old), size):
            self._history.append(weighed(old[start : start + size], self.rig, self.limit))

    def _tell(self, verdict: Verdict) -> list[str]:
        """Return a remark, unless all that it says has been said."""
        if verdict.cause in self._said or self._wrong.issuperset(verdict.cameras):
            return []
        self._said.add(verdict.cause)
        self._odd.update(verdict.cameras if verdict.clock else ())
        self._leave_out(verdict.cameras)
        return [verdict.text]
