import pytest

from trecsim.errors import ConfigError
from trecsim.estimators.estimator_settings import checked, cores
from trecsim.estimators.movenet import MoveNetSettings


def test_values_are_taken_and_the_rest_keeps_its_defaults():
    settings = checked(MoveNetSettings, {"long_side": 256, "min_joint_score": 0.1}, "movenet")
    assert settings == MoveNetSettings(long_side=256, min_joint_score=0.1)


def test_all_faults_come_in_one_message():
    wrong = {"long_sid": 256, "max_people": 0, "precision": "f8", "min_person_score": "high"}
    with pytest.raises(ConfigError) as caught:
        checked(MoveNetSettings, wrong, "movenet")
    told = str(caught.value)
    assert told.startswith("settings of the estimator 'movenet': ")
    assert "'long_sid' is unknown; did you mean 'long_side'?" in told
    for name in ("max_people", "precision", "min_person_score"):
        assert f"{name}: " in told


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("long_side", 0),
        ("long_side", 10**9),
        ("long_side", 51.5),
        ("long_side", None),
        ("min_joint_score", float("nan")),
        ("min_joint_score", 1.5),
        ("min_person_score", -0.1),
        ("threads", 0),
        ("max_people", 10**6),
        ("second_look", [256]),
        ("second_look", -1),
    ],
)
def test_values_out_of_range_or_of_another_type_are_refused(name, value):
    with pytest.raises(ConfigError, match=f"{name}: "):
        checked(MoveNetSettings, {name: value}, "movenet")


def test_there_is_a_core():
    assert cores() >= 1
