"""The table of scores that `trecsim evaluate` prints: one column per file of tracks."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trecsim.lab.evaluation.evaluating import Evaluation
    from trecsim.lab.evaluation.latency import Delay
    from trecsim.lab.evaluation.left_out import LeftOut, LeftOutRow
    from trecsim.lab.evaluation.limbs import LimbRow
    from trecsim.lab.evaluation.scores import Scores
    from trecsim.lab.evaluation.uncertainty_calibration import UncertaintyCalibration

UNKNOWN = "-"

Line = tuple[str, Sequence[str]]


def score_table(results: "Sequence[Evaluation]") -> str:
    """Return the scores of several tracks side by side."""
    lines: list[Line] = [("", _names(results))]
    if all(result.scores for result in results):
        lines += _against_truth([result.scores for result in results if result.scores])
    else:
        lines += _each(
            results,
            ("frames with people", lambda one: str(one.moments)),
            ("identities", lambda one: str(one.people)),
            ("  probably continuing an earlier identity", lambda one: str(len(one.fragmentations))),
        )
    lines += _without_truth(results)
    return _aligned(lines)


def details_table(result: "Evaluation") -> str:
    """Return the scores of each joint, limb and actor of one file of tracks."""
    parts = [str(result.tracks)]
    if result.scores:
        head = ("mean cm", "median cm", "p95 cm", "within 15 cm %")
        errors = [
            (one.joint, (_cm(one.mean_m), _cm(one.median_m), _cm(one.p95_m), _pc(one.recall_15cm)))
            for one in result.scores.joints
        ]
        parts.append(_aligned([("joint", head), *errors]))
        parts.append(_aligned(_calibration(result.scores)))
    if result.left_out:
        parts.append(_aligned(_left_out_lines(result.left_out)))
    if result.shelf:
        parts.append(_aligned(list(_actors(result))))
    parts.append(_aligned([("limb", ("mean cm", "sd cm", "true cm", "error cm")), *_limbs(result)]))
    return "\n\n".join(parts)


def _names(results: "Sequence[Evaluation]") -> list[str]:
    names = [result.tracks.name for result in results]
    return names if len(set(names)) == len(names) else [str(result.tracks) for result in results]


def _each(
    things: "Sequence[Evaluation]", *rows: "tuple[str, Callable[[Evaluation], str]]"
) -> list[Line]:
    return [(label, [tell(thing) for thing in things]) for label, tell in rows]


def _against_truth(scores: "Sequence[Scores]") -> list[Line]:
    rows: list[tuple[str, Callable[[Scores], str]]] = [
        ("frames", lambda one: str(one.moments)),
        ("person-frames in the ground truth", lambda one: str(one.person_moments)),
        ("joint error, mean [cm]", lambda one: _cm(one.error.mean_m)),
        ("  median [cm]", lambda one: _cm(one.error.median_m)),
        ("  95th percentile [cm]", lambda one: _cm(one.error.p95_m)),
        ("joints within 15 cm [%]", lambda one: _pc(one.error.recall_15cm)),
        ("missed person-frames [%]", lambda one: _counted(one.missed_share, one.missed)),
        (
            "false positive person-frames [%]",
            lambda one: _counted(one.false_positives_share, one.false_positives),
        ),
        ("frames with the right number of people [%]", lambda one: _pc(one.right_count)),
        ("identity switches", lambda one: str(one.identity.switches)),
        ("IDF1 [%]", lambda one: _pc(one.identity.idf1)),
        ("MOTA [%]", lambda one: _pc(one.identity.mota)),
        ("HOTA (DetA, AssA) [%]", _hota),
        ("delay of birth, median (max) [s]", lambda one: _delay(one.latency.birth)),
        ("track ends after person left, median (max) [s]", lambda one: _delay(one.latency.death)),
        (
            "ground truth inside the 50, 90, 95 % regions [%]",
            lambda one: _within(one.uncertainty_calibration),
        ),
        (
            "error / stated sigma, RMS",
            lambda one: _number(one.uncertainty_calibration.normalised_rms, 2),
        ),
    ]
    return [(label, [tell(one) for one in scores]) for label, tell in rows]


def _without_truth(results: "Sequence[Evaluation]") -> list[Line]:
    lines = _each(
        results,
        ("limb length, standard deviation [cm]", lambda one: _cm(one.limb_summary.sd_m)),
        ("  difference to the true length [cm]", lambda one: _cm(one.limb_summary.difference_m)),
        ("joint jitter [mm]", lambda one: _number(1e3 * one.jitter[0].jitter_m, 2)),
        ("joints supported by 0, 1, 2, 3+ cameras [%]", _support),
    )
    if any(one.reprojection for one in results):
        lines += _each(
            results, ("reprojection error, median (90th percentile) [px]", _reprojection)
        )
    if any(one.left_out for one in results):
        lines += _each(
            results,
            ("left-out camera inside the 50, 90, 99 % ellipses [%]", _left_out),
            ("  of their variance, noise of the detector [%]", _noise_share),
        )
    if any(one.shelf for one in results):
        lines += _each(results, ("PCP3D, mean of actors 1 to 3 [%]", _pcp))
    return lines


def _support(one: "Evaluation") -> str:
    return ", ".join(_number(100 * share, 0) for share in one.support[0].shares)


def _reprojection(one: "Evaluation") -> str:
    if one.reprojection is None:
        return UNKNOWN
    overall = one.reprojection.overall
    return f"{_number(overall.median_px, 1)} ({_number(overall.p90_px, 1)})"


def _left_out(one: "Evaluation") -> str:
    return UNKNOWN if one.left_out is None else _ellipses(one.left_out.overall)


def _noise_share(one: "Evaluation") -> str:
    return UNKNOWN if one.left_out is None else _pc(one.left_out.overall.noise_share)


def _ellipses(row: "LeftOutRow") -> str:
    return ", ".join(_number(100 * p, 0) for p in (row.within_50, row.within_90, row.within_99))


def _left_out_lines(found: "LeftOut") -> list[Line]:
    rows = [
        *((row.name, row) for row in found.cameras),
        *((f"support {row.name}", row) for row in found.supports),
    ]
    return [
        ("left-out camera", ("key points", "50, 90, 99 % [%]", "off px", "stated px", "noise %")),
        *(
            (
                name,
                (
                    str(row.key_points), _ellipses(row), _number(row.median_px, 1),
                    _number(row.stated_px, 1), _pc(row.noise_share),
                ),
            )
            for name, row in rows
        ),
    ]  # fmt: skip


def _pcp(one: "Evaluation") -> str:
    return UNKNOWN if one.shelf is None else _number(one.shelf.average, 2)


def _calibration(scores: "Scores") -> list[Line]:
    rows = {"all": scores.uncertainty_calibration, **scores.calibration_by_support}
    return [
        ("cameras", ("joints", "50, 90, 95 % [%]", "error/sigma")),
        *(
            (name, (str(one.joints), _within(one), _number(one.normalised_rms, 2)))
            for name, one in rows.items()
        ),
    ]


def _actors(result: "Evaluation") -> Iterator[Line]:
    rows = [actor.row() for actor in result.shelf.actors] if result.shelf else []
    for number, row in enumerate(rows):
        if number == 0:
            yield "actor", [name for name in row if name != "actor"]
        yield str(row["actor"]), [_number(row[name], 1) for name in row if name != "actor"]


def _limbs(result: "Evaluation") -> Iterator[Line]:
    for row in result.limbs:
        yield f"{row.person} {row.limb}", _limb(row)


def _limb(row: "LimbRow") -> list[str]:
    return [_cm(value) for value in (row.mean_m, row.sd_m, row.given_m, row.difference_m)]


def _hota(one: "Scores") -> str:
    parts = one.identity
    return f"{_pc(parts.hota)} ({_pc(parts.deta)}, {_pc(parts.assa)})"


def _delay(delay: "Delay") -> str:
    if delay.n == delay.never:
        return UNKNOWN if not delay.n else f"never ({delay.never})"
    never = f", never {delay.never}" if delay.never else ""
    return f"{_number(delay.median_s, 2)} ({_number(delay.max_s, 2)}){never}"


def _within(one: "UncertaintyCalibration") -> str:
    return ", ".join(_number(100 * p, 0) for p in (one.within_50, one.within_90, one.within_95))


def _counted(share: float, count: int) -> str:
    return f"{_pc(share)} ({count})"


def _cm(value_m: float) -> str:
    return _number(100 * value_m, 2)


def _pc(share: float) -> str:
    """Return a percentage; a share just below 1 or just above 0 is not rounded to it."""
    percent = 100 * share
    if 99.95 <= percent < 100:
        return f"{math.floor(1000 * percent) / 1000:.3f}"
    return f"{percent:.3f}" if 0 < percent < 0.05 else _number(percent, 1)


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else UNKNOWN


def _aligned(lines: Sequence[Line]) -> str:
    first = max(len(label) for label, _ in lines)
    widths = [max(len(line[1][at]) for line in lines) for at in range(len(lines[0][1]))]
    return "\n".join(
        f"{label:<{first}}  "
        + "  ".join(f"{value:>{width}}" for value, width in zip(values, widths, strict=True))
        for label, values in lines
    )
