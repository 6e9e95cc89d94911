"""What every export format is: an ending, what it can hold, and a writer."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from trecsim.export.motions import Motion, PersonMotion
from trecsim.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class About:
    """What a writer knows besides the motion.

    Attributes
    ----------
    name
        Name of the final file, for headers that repeat it.
    skeleton
        Names and limbs of the joints.
    """

    name: str
    skeleton: Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What goes into one file.

    Attributes
    ----------
    label
        What is put between the stem of the file name and its ending; empty for the only file.
    motion
        With only the people, and frames, of this file.
    """

    label: str
    motion: Motion

    @property
    def only(self) -> PersonMotion:
        """The person of a file that holds one."""
        return self.motion.people[0]


class Writer(Protocol):
    """Writes one file; the same motion gives the same file."""

    def __call__(self, motion: Motion, path: Path, about: About) -> None:
        """Write `motion` to `path`, which does not exist yet."""
        ...


@dataclass(frozen=True, slots=True)
class Format:
    """One export format.

    Attributes
    ----------
    ending
        Of file names, with the dot.
    title
        Name for messages.
    writer
        ``module:function`` of the :class:`Writer`, imported when it is used.
    one_person
        Whether a file holds one person.
    fixed_rate
        Whether the format needs frames at a fixed rate.
    needs
        Extra and modules of the optional packages that the writer uses.
    most_frames
        Number of frames that a file can hold; longer motion is split.
    holds_pose
        Whether the format cannot hold missing positions, so that the last pose is held in gaps.
    """

    ending: str
    title: str
    writer: str
    one_person: bool = False
    fixed_rate: bool = False
    needs: tuple[str, ...] = ()
    most_frames: int | None = None
    holds_pose: bool = False
