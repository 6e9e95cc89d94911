"""A remark, and on which cameras."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Verdict:
    """A remark.

    Attributes
    ----------
    cause
        Names what is wrong; the same cause is told once.
    text
        What is said.
    cameras
        Indices of the cameras of which nothing more needs to be said.
    sure
        Whether the reason is known; if not, a better one may be found.
    clock
        Whether a wrong clock, which is known at the end only, may be the reason.
    """

    cause: str
    text: str
    cameras: tuple[int, ...]
    sure: bool = True
    clock: bool = False
