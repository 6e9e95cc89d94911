"""What goes wrong in a scene, in numbers that can be summed over scenes and seeds."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness import regions
from harness.beside_truth import Beside, Left, in_view, left
from harness.figures import Figure, Figures, once

if TYPE_CHECKING:
    from trecsim.geometry import Rig

FAR_M = 0.25
TOO_LONG = 1.5  # a limb, by its true length
LOWEST_M = -0.1


@dataclass(frozen=True, slots=True)
class Counted:
    """Counts of one scene and seed, or of several.

    Attributes
    ----------
    joints, far, far_inside
        Joints found; those more than `FAR_M` off; of these, those inside their 99 % region.
    worst_m
        The largest error [m].
    limbs, long
        Limbs found, and those longer than `TOO_LONG` times the true one.
    people, missed, missed_by_all
        Person-moments; those without a confirmed track, and without any track.
    seen, missed_seen
        Person-moments in the view of a camera; those without any track.
    ghosts, leavers
        Confirmed tracks at moments at which they are nobody's; those of people no longer there.
    switches
        How often somebody bears another identity than before.
    left
        What became of the tracks of people who left all views.
    low
        Joints that are said to be below the floor.
    """

    joints: int
    far: int
    far_inside: int
    worst_m: float
    limbs: int
    long: int
    people: int
    missed: int
    missed_by_all: int
    seen: int
    missed_seen: int
    ghosts: int
    leavers: int
    switches: int
    left: tuple[Left, ...]
    low: int


def counted(confirmed: Beside, everybody: Beside, rig: "Rig") -> Counted:
    """Count what goes wrong.

    Parameters
    ----------
    confirmed, everybody
        The same tracks beside the truth, without and with those that are provisional.
    rig
        The cameras.
    """
    error_m = confirmed.error_m
    far = error_m > FAR_M
    squared = confirmed.errors(far).squared
    long, limbs = confirmed.limbs_too_long(TOO_LONG)
    known = np.isfinite(error_m)
    seen = in_view(confirmed, rig)
    return Counted(
        joints=int(known.sum()),
        far=int(far.sum()),
        far_inside=int((squared <= regions.limit(0.99, 3)).sum()),
        worst_m=float(error_m[known].max(initial=0.0)),
        limbs=limbs,
        long=long,
        people=int(confirmed.there.sum()),
        missed=confirmed.missed,
        missed_by_all=everybody.missed,
        seen=int(seen.sum()),
        missed_seen=int((seen & (everybody.identity < 0)).sum()),
        ghosts=len(confirmed.ghosts.t_s),
        leavers=confirmed.leavers,
        switches=confirmed.switches,
        left=tuple(left(confirmed, rig)),
        low=int((confirmed.found_m[..., 2] < LOWEST_M).sum()),
    )


def summed(some: Iterable[Counted]) -> Counted:
    """Return several as one."""
    each = list(some)

    def total(name: str) -> int:
        return sum(getattr(one, name) for one in each)

    return Counted(
        *(total(name) for name in ("joints", "far", "far_inside")),
        max(one.worst_m for one in each),
        *(total(name) for name in ("limbs", "long", "people", "missed", "missed_by_all",
                                   "seen", "missed_seen", "ghosts", "leavers", "switches")),
        tuple(gone for one in each for gone in one.left),
        total("low"),
    )  # fmt: skip


def figures_of(one: Counted) -> Figures:
    """Return them as figures."""
    out: dict[str, Figure] = {
        "worst joint": once(100 * one.worst_m, "cm", matters=5.0),
        "joints off more than 25 cm": once(_percent(one.far, one.joints), "%", matters=0.02),
        "of these inside their 99 % region": once(
            _percent(one.far_inside, one.far), "%", "higher", matters=3.0
        ),
        "limbs over 1.5 x the true length": once(_percent(one.long, one.limbs), "%", matters=0.02),
        "missed": once(_percent(one.missed, one.people), "%", matters=0.2),
        "missed, provisional people counted": once(
            _percent(one.missed_by_all, one.people), "%", matters=0.2
        ),
        "missed in view, provisional people counted": once(
            _percent(one.missed_seen, one.seen), "%", matters=0.2
        ),
        "ghosts": once(_percent(one.ghosts, one.people), "%", matters=0.1),
        "ghosts, not of who left": once(
            _percent(one.ghosts - one.leavers, one.people), "%", matters=0.1
        ),
        "switches": once(one.switches, "", matters=0.0),
        "joints below the floor": once(one.low, "", matters=0.0),
        "person-moments": once(one.people, "", watched=False),
    }
    for who, some in (
        ("who left", one.left),
        ("who walked out of all views", [gone for gone in one.left if gone.walked_out]),
    ):
        if some:
            after_s = np.array([gone.after_s for gone in some])
            out[f"{who}, gone after, median"] = once(float(np.median(after_s)), "s", matters=0.05)
            out[f"{who}, gone after, latest"] = once(float(after_s.max()), "s", matters=0.05)
            out[f"{who}, number"] = once(len(after_s), "", watched=False)
    return out


def _percent(part: int, whole: int) -> float:
    return 100 * part / whole if whole else float("nan")
