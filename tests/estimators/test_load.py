import pytest

from trecsim import estimators
from trecsim.errors import ConfigError, SetupError
from trecsim.estimators import image_limit_px, load, names, workers


class Nobody:
    skeleton = "coco17"

    def __call__(self, frame):
        raise NotImplementedError


class Point:
    """Stands in for an entry point."""

    def __init__(self, name, made):
        self.name, self.value, self._made = name, f"{name}:load", made

    def load(self):
        if isinstance(self._made, Exception):
            raise self._made
        return self._made


@pytest.fixture
def installed(monkeypatch):
    points = []
    monkeypatch.setattr(estimators, "entry_points", lambda group: points)
    return points


def test_ours_are_installed():
    assert {"movenet", "onnx", "rtmlib"} <= set(names())


def test_what_stands_after_the_colon_and_the_settings_reach_the_estimator(installed):
    given = {}

    def make(argument, **settings):
        given.update(settings, argument=argument)
        return Nobody()

    installed.append(Point("theirs", make))
    assert isinstance(load("theirs:a:b", size=3), Nobody)
    assert given == {"argument": "a:b", "size": 3}


def test_an_unknown_name_is_told_with_the_nearest():
    with pytest.raises(ConfigError, match=r"no estimator called 'movnet' is installed; known: .*"):
        load("movnet")
    with pytest.raises(ConfigError, match="did you mean 'movenet'"):
        load("movnet")


def test_no_name_is_told():
    with pytest.raises(ConfigError, match="no estimator called ''"):
        load("")


@pytest.mark.parametrize("fault", [ImportError("no module x"), AttributeError("no load")])
def test_a_plug_in_that_does_not_load_is_told(installed, fault):
    installed.append(Point("theirs", fault))
    with pytest.raises(SetupError, match=r"'theirs' .* does not load: no"):
        load("theirs")


@pytest.mark.parametrize("thing", [None, object(), 3])
def test_a_plug_in_that_is_no_estimator_is_told(installed, thing):
    installed.append(Point("theirs", lambda argument: thing))
    with pytest.raises(SetupError, match="is no estimator"):
        load("theirs")


def test_a_plug_in_with_a_skeleton_nobody_knows_is_told(installed):
    nobody = Nobody()
    nobody.skeleton = "octopus"
    installed.append(Point("theirs", lambda argument: nobody))
    with pytest.raises(SetupError, match="skeleton 'octopus'"):
        load("theirs")


def test_who_says_nothing_works_alone_on_images_of_any_size():
    assert workers(Nobody()) == 1
    assert image_limit_px(Nobody()) is None
