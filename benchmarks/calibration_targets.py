"""What is asked of calibrations, and where the figure reached is stored."""

from targets import Relation, Target

_BOARD, _PEOPLE, _VIDEO = "cameras from a board", "cameras from people", "cameras of real video"
_FILE = "people_calibration"
_OTHERS_DEG = "humancalib 0.34-0.51, Lee 2025 0.4-1 (recorded; other data)"


def _people() -> list[Target]:
    def of(case: str, what: str, asked: str, limit: float, unit: str = "", figure: str = "",
           peers: str = "") -> Target:  # fmt: skip
        relation: Relation = "<=" if asked == "at most" else ">="
        text = what if "*" in case else f"{case}: {what}"
        return Target(_PEOPLE, text, (_FILE, case, figure or what), relation, limit, unit, peers)

    three = "three walkers"
    return [
        of(three, "rotation, median", "at most", 0.12, "degrees", "rotation", _OTHERS_DEG),
        of(three, "rotation, worst camera of all seeds", "at most", 0.25, "degrees",
           "worst camera"),
        of(three, "position", "at most", 1.5, "cm"),
        of(three, "scale", "at most", 0.5, "%"),
        of(three, "offset of clocks, worst camera", "at most", 2.5, "ms", "offset"),
        of(three, "precision of who is who", "at least", 0.99, "", "precision",
           "Lee 2025 0.71-0.90 (recorded; other data)"),
        of(three, "recall of who is who", "at least", 0.9, "", "recall"),
        of(three, "recordings that failed", "at most", 0, "", "failed"),
        of(three, "processor time", "at most", 8, "s"),
        of("one walker", "rotation, median", "at most", 0.2, "degrees", "rotation"),
        of("two cameras", "rotation, median", "at most", 0.25, "degrees", "rotation"),
        of("eight cameras", "rotation, median", "at most", 0.12, "degrees", "rotation"),
        of("eight cameras", "processor time", "at most", 20, "s"),
        of("bias by view", "rotation, median", "at most", 0.2, "degrees", "rotation"),
        of("two minutes", "drift of clocks, worst camera", "at most", 25, "ppm", "drift"),
        of("five minutes", "drift of clocks, worst camera", "at most", 10, "ppm", "drift"),
        of("[!lab]*", "turns in their 90 % regions, worst kind", "at least", 80, "%",
           "turns in the 90 % region"),
        of("bias by view", "turns in their 90 % regions", "at least", 80, "%",
           "turns in the 90 % region"),
        of("[!l]*", "tracking error / that with the true cameras, worst kind", "at most", 1.3, "x",
           "tracking"),
        of("*", "called good though off by a degree, all kinds", "at most", 0, "",
           "good though off by 1 degree"),
        of("[tobe]*", "good, of those within 0.3 degrees, worst kind", "at least", 95, "%",
           "good of those within 0.3 degrees"),
        of("lenses off", "called good", "at most", 0),
        of("a camera knocked", "called good", "at most", 0),
    ]  # fmt: skip


CALIBRATION: tuple[Target, ...] = (
    Target(_BOARD, "well moved: rotation", ("board_calibration", "well moved", "rotation, mean"),
           "<=", 0.05, "degrees"),
    Target(_BOARD, "well moved: position", ("board_calibration", "well moved", "position, mean"),
           "<=", 3, "mm"),
    Target(_BOARD, "well moved: processor time",
           ("board_calibration", "well moved", "processor time"), "<=", 60, "s"),
    Target(_BOARD, "well moved: rotation / OpenCV's calibrateMultiview",
           ("board_calibration", "well moved / OpenCV", "rotation, mean"), "<=", 1.02, "x"),
    Target(_BOARD, "called good though off by a degree, all kinds",
           ("board_calibration", "verdicts", "good though off by 1 degree"), "<=", 0),
    Target(_BOARD, "good, of those within 0.3 degrees",
           ("board_calibration", "verdicts", "good of those within 0.3 degrees"), ">=", 95, "%"),
    Target(_BOARD, "knocked by 0.5 degrees in mid-recording: called good",
           ("board_calibration", "knocked", "called good"), "<=", 0, "%"),
    *_people(),
    Target(_VIDEO, "MultiPerson at left-out cameras, repaired on SinglePerson / as delivered",
           ("repairing", "repaired / as delivered", "MultiPerson"), "<=", 0.5, "x"),
    Target(_VIDEO, "a beam's corners, cameras repaired on a man, cam01 and cam02",
           ("repairing", "repaired", "beam", "cam0[12]"), "<=", 10, "px"),
    Target(_VIDEO, "MultiPerson at left-out cameras, from people of SinglePerson / repaired",
           ("repairing", "from people / repaired", "MultiPerson"), "<=", 1.2, "x"),
)  # fmt: skip
"""What calibrations are to reach."""
