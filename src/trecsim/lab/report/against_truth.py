"""Errors of a recording against its ground truth."""

from trecsim.errors import SetupError
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.lab.evaluation.latency import Delay
from trecsim.lab.evaluation.scores import JointScore, Scores
from trecsim.lab.report.page import Block, Fact, Facts, Figure, Section, Table, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import as_svg, draw_spreads, figure

TITLE = "Against ground truth"
LEAD = "The true positions are known for this recording: it is synthetic, or annotated."


def scores_of(recording: Recording) -> Scores | str | None:
    """Return the scores; the missing package as text; None without ground truth.

    Raises
    ------
    InputError
        Tracks and ground truth do not belong together.
    """
    if recording.truth is None:
        return None
    from_s, until_s = recording.range_s
    try:
        return evaluate(
            recording.places.tracks, recording.truth, from_s=from_s, until_s=until_s
        ).scores
    except SetupError as error:
        return str(error)


def section(scores: Scores | str) -> Section:
    """Return errors, what was missed, and how well identities were kept."""
    if isinstance(scores, str):
        return Section(TITLE, [Text(f"The scores could not be computed: {scores}", "missing")])
    blocks: list[Block] = [Facts(_facts(scores))]
    if scores.error.found:
        blocks.append(Figure(_errors(scores), _CAPTION, "Error by joint"))
    blocks.append(_table(scores))
    return Section(TITLE, blocks, LEAD)


_CAPTION = (
    "Distance of each joint from its true position, of people who were tracked. The dot is the "
    "median, the bar ends at the 95th percentile."
)


def _facts(scores: Scores) -> list[Fact]:
    error, identity = scores.error, scores.identity
    return [
        Fact("joint error", _cm(error.median_m), f"median; 95th percentile {_cm(error.p95_m)}"),
        Fact("within 15 cm", _percent(error.recall_15cm), "of all true joints"),
        Fact("missed", _percent(scores.missed_share), "of the person-frames"),
        Fact("false positives", _percent(scores.false_positives_share), "of the person-frames"),
        Fact("identity switches", f"{identity.switches}", f"IDF1 {_number(identity.idf1)}"),
        Fact("right count", _percent(scores.right_count), "of the frames"),
    ]


def _cm(length_m: float) -> str:
    return f"{100 * length_m:.1f} cm" if length_m == length_m else "–"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share == share else "–"


def _number(score: float) -> str:
    return f"{score:.3f}" if score == score else "–"


def _seconds(delay: Delay) -> str:
    return f"{delay.median_s:.2f} s" if delay.median_s == delay.median_s else "–"


def _errors(scores: Scores) -> str:
    joints: tuple[JointScore, ...] = scores.joints
    with figure(3.9) as drawing:
        axes = drawing.add_subplot()
        spreads = [(0.0, 100 * joint.median_m, 100 * joint.p95_m) for joint in joints]
        draw_spreads(axes, [joint.joint for joint in joints], spreads)
        axes.set_xlabel("error [cm]")
        return as_svg(drawing, "truth")


def _table(scores: Scores) -> Table:
    identity, latency = scores.identity, scores.latency
    rows = [
        ("mean joint error (MPJPE)", _cm(scores.error.mean_m), "of people who were tracked"),
        ("IDF1", _number(identity.idf1), "person-frames with the right identity (F1)"),
        (
            "MOTA",
            _number(identity.mota),
            "1 minus the shares of missed, false positives and switches",
        ),
        ("HOTA", _number(identity.hota), "detection and association combined"),
        (
            "ground truth inside the 90 % region",
            _percent(scores.uncertainty_calibration.within_90),
            "90 % is calibrated, less is overconfident, more is underconfident",
        ),
        ("delay of birth", _seconds(latency.birth), "median time until a person is tracked"),
        ("track end", _seconds(latency.death), "median time after the person left"),
    ]
    return Table(("score", "value", "meaning"), rows, align=("left", "right", "left"))
