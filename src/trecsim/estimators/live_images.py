"""2D poses from the images of live cameras; an estimator that hangs costs only that camera."""

import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from queue import SimpleQueue
from threading import Lock, Semaphore, Thread

from trecsim.errors import Error, InputError
from trecsim.estimators import Estimator2D, workers
from trecsim.sources.camera_mailbox import TICK_S, Mailbox, as_fault
from trecsim.sources.image_sizes import in_original
from trecsim.values import Frame, Poses2D

STALLED_S = 10.0
"""An estimator that takes longer than this for an image hangs [s]."""
_MOST_STALLED = 8  # threads that hang, besides those that work
_LIVE_DEPTH = 16  # poses of a camera that may wait for the fusion

Fault = Callable[[Exception], None]


def estimate_live(
    frames: Mailbox[Frame],
    estimator: Estimator2D,
    fault: Fault,
    *,
    stalled_s: float = STALLED_S,
) -> Mailbox[Poses2D]:
    """Find the people in the images of live cameras; return where the 2D poses arrive.

    An image is taken when a thread is free for it, so images wait, and are dropped, in `frames`.
    The poses of one camera keep their order, whichever thread is done first. Key points are pixels
    of the images as the cameras took them, whatever size they come at.

    Where the estimator hangs on an image, that camera gets no more poses until it returns; another
    thread goes on with the other cameras.

    Parameters
    ----------
    frames
        Where the images arrive.
    estimator
        Called by as many threads as it takes.
    fault
        Is told, in another thread, when the estimator failed on an image or hangs; the next are
        tried.
    stalled_s
        An estimator that takes longer for an image hangs [s].
    """
    poses: Mailbox[Poses2D] = Mailbox(_LIVE_DEPTH)
    poses.begin()
    work = _Work(estimator, fault, poses, stalled_s)

    def run() -> None:
        try:
            work.run(frames)
        except BaseException as error:  # the boundary of the thread: whatever it is, it is told
            fault(as_fault(error))
        finally:
            frames.close()
            poses.end()

    Thread(target=run, name="estimate", daemon=True).start()
    return poses


@dataclass(slots=True, eq=False)
class _Task:
    """One image that the estimator looks at; it is let go once that is done."""

    camera: str
    frame: Frame | None
    began_s: float = field(default_factory=time.monotonic)
    found: Future[object] = field(default_factory=Future)
    is_stalled: bool = False


class _Work:
    """The threads that call the estimator, and what they are at.

    They are daemons: a thread that hangs in an estimator must not keep the process from ending.
    """

    def __init__(
        self, estimator: Estimator2D, fault: Fault, poses: Mailbox[Poses2D], stalled_s: float
    ) -> None:
        self._estimator, self._fault, self._poses = estimator, fault, poses
        self._stalled_s = stalled_s
        self._count = workers(estimator)
        self._free = Semaphore(self._count)
        self._queue: SimpleQueue[_Task | None] = SimpleQueue()
        self._lock = Lock()
        self._begun: dict[str, deque[_Task]] = {}
        self._replaced = 0

    def run(self, frames: Mailbox[Frame]) -> None:
        """Give images to threads until no more come, and wait for those that do not hang."""
        for _ in range(self._count):
            self._start()
        try:
            while not frames.is_over and not self._poses.closed:
                self._watch()
                if not self._free.acquire(timeout=TICK_S):
                    continue
                frame = frames.take(TICK_S)
                if frame is None or self._hangs_at(frame.camera):
                    self._free.release()
                    continue
                task = _Task(frame.camera, frame)
                del frame
                with self._lock:
                    self._begun.setdefault(task.camera, deque()).append(task)
                self._queue.put(task)
            self._finish()
        finally:
            for _ in range(self._count + self._replaced):
                self._queue.put(None)

    def _start(self) -> None:
        Thread(target=self._work, name="estimate-image", daemon=True).start()

    def _work(self) -> None:
        while (task := self._queue.get()) is not None:
            frame, task.frame = task.frame, None  # results may wait long behind one that hangs
            assert frame is not None
            try:
                task.found.set_result(_estimated(self._estimator, frame))
            except BaseException as error:  # the boundary of the estimator: it is told
                task.found.set_exception(error)
            del frame
            if self._done(task):
                return

    def _done(self, task: _Task) -> bool:
        """Pass on what was found, in the order of the images; tell whether to end the thread."""
        with self._lock:
            was_stalled = task.is_stalled
            begun = self._begun[task.camera]
            while begun and begun[0].found.done():
                done = begun.popleft()
                error = done.found.exception()
                if error is None:
                    _put(done.found.result(), self._poses, self._fault)
                else:
                    self._fault(as_fault(error))
            if was_stalled:
                self._replaced -= 1
        if not was_stalled:
            self._free.release()
        return was_stalled  # another has taken its place

    def _hangs_at(self, camera: str) -> bool:
        with self._lock:
            return any(task.is_stalled for task in self._begun.get(camera, ()))

    def _watch(self) -> None:
        """Put another thread in the place of each that hangs, and tell."""
        now_s = time.monotonic()
        with self._lock:
            late = [
                task
                for begun in self._begun.values()
                for task in begun
                if not (task.found.done() or task.is_stalled)
                and now_s - task.began_s > self._stalled_s
            ][: _MOST_STALLED - self._replaced]
            for task in late:
                task.is_stalled = True
            self._replaced += len(late)
        for task in late:
            self._start()
            self._free.release()
            self._fault(
                Error(
                    f"camera {task.camera!r}: the estimator has been at one image for "
                    f"{self._stalled_s:g} s; this camera gets no 2D poses until it returns, the "
                    "others go on"
                )
            )

    def _finish(self) -> None:
        """Wait until all images that were begun are done, or hang."""
        while not self._poses.closed:
            self._watch()
            with self._lock:
                if not any(not t.is_stalled for begun in self._begun.values() for t in begun):
                    return
            time.sleep(TICK_S)


def _estimated(estimator: Estimator2D, frame: Frame) -> object:
    """Return the 2D poses in an image, in pixels of the image as the camera took it."""
    poses: object = estimator(frame)
    if frame.size_px is None or not isinstance(poses, Poses2D):
        return poses
    height, width = frame.image.shape[:2]
    return in_original(poses, (width, height), frame.size_px)


def _put(found: object, poses: Mailbox[Poses2D], fault: Fault) -> None:
    """Let 2D poses wait, and tell if an estimator returned something else."""
    if isinstance(found, Poses2D):
        poses.put(found)
    else:
        fault(InputError(f"the estimator returned {type(found).__name__}; expected Poses2D"))
