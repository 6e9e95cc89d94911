"""What speaks for and against a rig calibrated from people; never reprojection alone."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.body_pairs import BodyRelation
from trecsim.calibrating.people.found import Found
from trecsim.calibrating.people.holding_out import Part
from trecsim.calibrating.people.lenses import lenses_off
from trecsim.calibrating.people.scale import Scale
from trecsim.calibrating.people.steadiness import Step
from trecsim.calibrating.people.tuning import BODY_LAGS_S
from trecsim.calibrating.result import GOOD_DEG, NINETY, USABLE_DEG, Finding, Verdict

APART = 3.5
"""Parts that differ by so many of their standard deviations contradict each other."""
APART_DEG = 0.35
"""Unless they differ by less [degrees]."""
CLOCK_APART, GOOD_CLOCK_S, USABLE_CLOCK_S = 6.0, 0.03, 0.1
"""The halves' clocks contradict each other beyond so many standard deviations and seconds."""
GOOD_RECALL, USABLE_RECALL = 0.6, 0.3
CLEAR = 1.6
"""A relation of two cameras is clear when the next best has so many times less evidence."""
FEWEST_SECONDS = 15.0


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """All that a verdict rests on.

    Attributes
    ----------
    names
        Of the cameras.
    found
        What was found.
    parts
        Parts of the recording against each other.
    steps
        Cameras whose view changed while recording.
    rotation_sd_deg
        Per camera that was found, inflated by what the parts say [degrees].
    scale
        Where the scale comes from.
    recall
        Share of the time for which people are seen in which they are in a chain of two cameras.
    """

    names: Sequence[str]
    found: Found
    parts: Sequence[Part]
    steps: Sequence[Step]
    rotation_sd_deg: Float64[np.ndarray, " found"]
    scale: Scale
    recall: float


def findings(evidence: Evidence) -> Iterator[Finding]:
    """Yield everything that was looked at."""
    yield from _missing(evidence)
    yield from _sure(evidence)
    yield from _parts(evidence)
    yield from _clocks(evidence)
    yield from _steps(evidence)
    yield from _amount(evidence)
    yield from _by_bodies(evidence)
    yield from _clear(evidence)
    yield from _lenses(evidence)
    yield evidence.scale.finding


def inflation(parts: Sequence[Part]) -> float:
    """Return by how much the standard deviations are too small, as parts that differ show.

    Parts of a recording are compared by as many numbers as cameras turn; a ratio of a few numbers
    scatters, and less than 1 is no reason to be surer.
    """
    halves = [part for part in parts if part.kind == "time"]
    others = [part for part in parts if part.kind == "person"]
    ratios = [
        float(np.sqrt((part.turn_deg**2).sum() / (part.expected_deg**2).sum()))
        for part in (*halves, *others)
    ]
    return max(1.0, *ratios) if ratios else 1.3


def _missing(evidence: Evidence) -> Iterator[Finding]:
    lost = [n for n, known in zip(evidence.names, evidence.found.priors.found, strict=True)
            if not known]  # fmt: skip
    if lost:
        listed = ", ".join(map(repr, lost))
        yield Finding(
            "usable",
            f"not found: {listed}; nobody was seen there together with another camera: let people "
            "walk where it and another camera see them from head to foot",
        )


def _sure(evidence: Evidence) -> Iterator[Finding]:
    worst = int(np.argmax(evidence.rotation_sd_deg))
    error_deg = NINETY * float(evidence.rotation_sd_deg[worst])
    which = np.flatnonzero(evidence.found.priors.found)
    name = evidence.names[which[worst]]
    verdict: Verdict = (
        "good" if error_deg <= GOOD_DEG else "usable" if error_deg <= USABLE_DEG else "wrong"
    )
    text = f"with 90 % probability every camera is turned by less than {error_deg:.2f} degrees"
    if verdict != "good":
        text += f"; {name!r} is the least sure: let people walk longer, and across its whole view"
    yield Finding(verdict, text)


def _parts(evidence: Evidence) -> Iterator[Finding]:
    names = evidence.names
    for part in evidence.parts:
        if not len(part.cameras):
            continue
        expected = np.maximum(part.expected_deg, 1e-3)
        worst = int(np.argmax(part.turn_deg / expected))
        apart = float(part.turn_deg.max())
        if part.turn_deg[worst] < APART * expected[worst] or apart < APART_DEG:
            if part.kind == "time":
                yield Finding(
                    "good",
                    f"both halves of the recording give the same rig within {apart:.2f} degrees",
                )
            continue
        camera = names[int(part.cameras[int(np.argmax(part.turn_deg))])]
        verdict: Verdict = "wrong" if apart > 3.0 * APART_DEG or part.kind == "time" else "usable"
        yield Finding(verdict, _contradiction(part, camera, apart))


def _clocks(evidence: Evidence) -> Iterator[Finding]:
    for part in evidence.parts:
        apart_s = float(np.abs(part.late_s).max(initial=0.0))
        if apart_s < max(GOOD_CLOCK_S, CLOCK_APART * part.expected_late_s):
            continue
        named = evidence.names[int(part.cameras[int(np.argmax(np.abs(part.late_s)))])]
        yield Finding(
            "usable" if apart_s < USABLE_CLOCK_S else "wrong",
            f"the clock of {named!r} differs by {1e3 * apart_s:.0f} ms between the two halves of "
            "the recording: it jumped, or images are missing that were counted; record again, or "
            "use the part before or after",
        )


def _contradiction(part: Part, camera: str, apart_deg: float) -> str:
    if part.kind == "time":
        return (
            f"the two halves of the recording contradict each other: {camera!r} is turned by "
            f"{apart_deg:.2f} degrees between them; it was moved while recording, or its clock "
            "jumped: record again"
        )
    if part.kind == "person":
        return (
            f"without {part.name}, {camera!r} is turned by {apart_deg:.2f} degrees: somebody is "
            "taken for somebody else; record with fewer people"
        )
    return (
        f"without camera {part.name!r}, {camera!r} is turned by {apart_deg:.2f} degrees: "
        f"{part.name!r} does not fit the others; check its intrinsics and that it was not moved"
    )


def _steps(evidence: Evidence) -> Iterator[Finding]:
    for step in evidence.steps:
        yield Finding(
            "wrong",
            f"{evidence.names[step.camera]!r} looks {step.turn_deg:.2f} degrees elsewhere from "
            f"{step.since_s:.1f} s on: it was moved while recording; use a part of the recording "
            "before or after",
        )


def _amount(evidence: Evidence) -> Iterator[Finding]:
    t_s = evidence.found.seen.t_s
    seconds = float(np.ptp(t_s)) if len(t_s) else 0.0
    if seconds < FEWEST_SECONDS:
        yield Finding(
            "usable",
            f"the recording has people in two cameras for {seconds:.1f} s only: let them walk for "
            "40 s and more",
        )
    if evidence.recall < GOOD_RECALL:
        verdict: Verdict = "usable" if evidence.recall >= USABLE_RECALL else "wrong"
        yield Finding(
            verdict,
            f"only {evidence.recall:.0%} of what the cameras saw of people could be matched "
            "between them: people may be mistaken for each other; record with two or three people "
            "whom several cameras see at the same time",
        )


def _by_bodies(evidence: Evidence) -> Iterator[Finding]:
    if any(isinstance(one, BodyRelation) for one in evidence.found.relations):
        yield Finding(
            "usable",
            "nobody walked far enough to bring the clocks into step: the cameras were related by "
            "bodies alone, and their clocks are taken to differ by less than "
            f"{max(BODY_LAGS_S):.1f} s; let people walk for 40 s, in curves, over the whole floor",
        )


def _lenses(evidence: Evidence) -> Iterator[Finding]:
    found = evidence.found
    if found.doubts_lenses:
        yield Finding(
            "usable",
            "other intrinsics would explain clearly better what people show, but the halves of the "
            "recording do not agree on them, so the given ones were kept: measure them with "
            "trecsim calibrate intrinsics, or record for longer",
        )
    if found.priors.lens_sd is None:
        return
    lens = np.where(found.priors.found[:, None], found.rig.state.lens, 0.0)
    worst = int(np.argmax(np.abs(lens).max(axis=1)))
    off = lenses_off(found.rig, found.priors.own) & found.priors.found
    off[worst] = True
    focal, right, down = lens[worst]
    named = ", ".join(repr(evidence.names[int(c)]) for c in np.flatnonzero(off))
    yield Finding(
        "usable",
        f"the given intrinsics do not fit what people show: those of {named} are off, of "
        f"{evidence.names[worst]!r} the focal length by {focal:+.1%} and the principal point by "
        f"({right:+.1%}, {down:+.1%}) of it; all were refined: trecsim calibrate intrinsics does "
        "better",
    )


def _clear(evidence: Evidence) -> Iterator[Finding]:
    chosen = [one for one in evidence.found.relations if one.score > 0]
    best: dict[int, float] = {}
    for one in chosen:
        ratio = one.score / max(one.rival, 1e-9)
        for camera in (one.a, one.b):
            best[camera] = max(best.get(camera, 0.0), ratio)
    for camera, ratio in best.items():
        if ratio < CLEAR:
            yield Finding(
                "usable" if ratio > 1.2 else "wrong",
                f"how {evidence.names[camera]!r} stands to the others is ambiguous: another "
                "arrangement explains the people's ways nearly as well; let people walk curves, "
                "stop and turn, not only straight lines",
            )
