"""The page of the model states the numbers that the code has."""

import math
import re
from pathlib import Path

import pytest

from trecsim.consistency import learnt_errors
from trecsim.fusion import body, tuning

MODEL = Path(__file__).parents[2] / "docs" / "model.md"
PAGE = re.sub(r"\s+", " ", re.sub(r"\n *[>-] ", " ", MODEL.read_text(encoding="utf-8")))


def degrees(rad: float) -> float:
    """Return an angle in degrees, to two digits."""
    return float(f"{math.degrees(rad):.2g}")


def root(variance: float) -> float:
    """Return a standard deviation."""
    return round(math.sqrt(variance), 6)


# Words of the page, with numbers of the code in them.
STATED = (
    f"$d$ is {tuning.KEPT:g} times the torso's velocity",
    f"$d$ is {tuning.KEPT_UNSEEN:g} times that velocity",
    f"grows by up to {tuning.LEEWAY:g} times itself, but by no more than "
    f"({100 * tuning.LEEWAY_M:g} cm)²",
    f"the exponent tempered by $T = {tuning.TEMPER:g}$",
    f"at most by {tuning.LARGEST_INFLATION:g} (`NIS_GATE`",
    f"in that camera over the last {tuning.VIEW_OFFSET_S:g} s",
    f"with the prior $z = 0 \\pm {tuning.FIRST_LEVEL_SIGMA_M:g}$ m",
    f"a total standard deviation above {root(tuning.WEAK_M2):g} m although",
    f"({root(tuning.REACH_M2):g}\\,\\mathrm{{m}})^{{-2}}",
    f"with a time constant of {tuning.BODY_S:g} s",
    f"averaged over {tuning.PLACE_S:g} s (`PLACE_S`)",
    f"{tuning.PLACE_SURE:g} (`PLACE_SURE`) the joint is moved",
    f"within {tuning.CAMERA_BLOCK_S:g} s (`CAMERA_BLOCK_S`",
    f"looked at {tuning.CAMERA_LAG_S:g} s after their block (`CAMERA_LAG_S`)",
    f"forgotten over {tuning.CAMERA_ERROR_S:g} s",
    f"every {tuning.CAMERA_CHECK_S:g} s in the first {tuning.CAMERA_SETTLE_S:g} s, then every "
    f"{tuning.CAMERA_RENEW_S:g} s",
    f"{1e3 * tuning.TURN_SIGMA_RAD:g} mrad for each angle and "
    f"{1e3 * tuning.CLOCK_SIGMA_S:g} ms for the",
    f"beyond {1e3 * tuning.PUSHED_RAD:g} mrad or {1e3 * tuning.PUSHED_S:g} ms (`PUSHED_*`)",
    f"+ {tuning.SURE**2:g} \\sigma^2)",
    f"at least {1e3 * tuning.LEAST_TURN_RAD:g} mrad",
    f"turns of {degrees(learnt_errors._TOLD_RAD):g} to {degrees(learnt_errors._MOST_RAD):g} "
    f"degrees and delays above {1e3 * learnt_errors._TOLD_S:g} ms",
    f"deviations large for {learnt_errors._LASTS_S:g} s",
    f"{tuning.UNSEEN_SIGMA_M:g} m, plus {tuning.UNSEEN_DRIFT_MPS:g} m for each second",
    f"Within the {tuning.TWO_PLACES_S:g} s after a second camera has lost the joint",
    f"the excess $e^2/{tuning.LIMB_GATE**2:g} - v$",
    f"${tuning.BIAS_WANDER_PER_S**2:g}\\,[\\dots]^{{-1}}$ per square second",
    f"with a bound of {tuning.UNSEEN_SIGMA_MPS:g} m/s in place of $o$",
    f"miss each other by $\\Delta t$ times {tuning.PAIR_MPS:g} m/s",
    f"${tuning.LOOK_SEES:.1f}\\,n - {tuning.LOOK_MISSES:.2g}\\,m$",
    f"left and right exchanged for {tuning.MIRROR_S:g} s",
    f"{tuning.LOOK_BACK:g} of its usual intervals, at least {tuning.SUPPORT_S:g} s and at most "
    f"{tuning.LONGEST_SUPPORT_S:g} s",
    f"The gate widens by {tuning.LEEWAY_MPS:g} m/s for the time since a track was last seen, up to "
    f"{tuning.MOST_SLACK:g} times",
    f"at {tuning.UNSEEN_MPS:g} m/s ({tuning.YOUNG_MPS:g} m/s if the track was younger than "
    f"{tuning.YOUNG_S:g} s)",
    f"explain about as well for {tuning.REDUNDANT_CHECKS * tuning.CHECK_S:.2g} s",
    f"($b_s$, {100 * tuning.SIZE_SPREAD:g} %)",
    f"$b_s$ is known to {100 * tuning.KNOWN_SIZE_SPREAD:g} %",
    f"less than {tuning.UPRIGHT:g} of their lengths high (and {tuning.SAT_DOWN:g} once measured)",
    f"becomes less sure by {100 * root(tuning.RANGE_DRIFT2_PER_S):g} % of it in the first second",
    f"its detections have supported it for {tuning.SINGLE_VIEW_S:g} s",
    f"There are at most {tuning.MOST_SINGLE_VIEWS} such tracks",
)
WORDS = (
    ("Above a limit the person has turned", tuning.NIS_GATE > tuning.USUAL_NIS > 1.0),
    ("in three Gauss-Newton steps", tuning.BODY_STEPS == 3),
    ("There are at most three steps", tuning.EM_STEPS == 3),
    ("for each second for which no two cameras have supported the joint, up to five",
     tuning.UNSEEN_DRIFT_S == 5.0),
    ("more than three standard deviations, it does not rest", tuning.GROUND_GATE == 3.0),
    ("residual $e$ of more than three standard deviations", tuning.LIMB_GATE == 3.0),
    ("17 of them as a third", tuning.TEMPER == 3.0),
    ("a point in space takes up three", 2 * tuning.EYES_OF_A_POINT == 3.0),
    ("have been five standard deviations large", learnt_errors._SIGMAS == 5.0),
    ("by about one standard deviation in 0.2 s", tuning.BIAS_WANDER_PER_S == 1 / 0.2),
    ("confirmed at once if three cameras agree", tuning.SURE_CAMERAS == 3),
    ("or only one of three or more cameras", tuning.CROWDED == 3),
    ("It is sooner, by up to a half, if more than two cameras",
     tuning.LEAST_PATIENCE == 0.5 and tuning.USUAL_CAMERAS == 2.0),
    ("makes it half as long again; where two or more do, it is not reported",
     tuning.MISSED_PATIENCE == 1.5 and tuning.CROWDED == 3),
    ("has supported it for a quarter of a second", tuning.SINGLE_VIEW_PATIENCE_S == 0.25),
)  # fmt: skip


@pytest.mark.parametrize("words", STATED)
def test_numbers_of_the_page_are_those_of_the_code(words: str) -> None:
    assert words in PAGE


@pytest.mark.parametrize(("words", "holds"), WORDS)
def test_what_the_page_says_in_words_holds_in_the_code(words: str, holds: bool) -> None:
    assert words in PAGE
    assert holds


def test_constants_that_the_page_names_exist() -> None:
    named = re.findall(r"`(_?[A-Z][A-Z0-9_]+)(\*?)`", PAGE)
    assert len(named) >= 8
    for name, rest in named:
        known = [each for each in (*vars(tuning), *vars(body)) if each.isupper()]
        assert any(each.startswith(name) if rest else each == name for each in known), name
