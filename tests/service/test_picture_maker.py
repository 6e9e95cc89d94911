"""Pictures of the cameras: only for those who look, few, and the newest."""

import io

import numpy as np
import pytest

from trecsim.service.picture_maker import LOOKS_S, PictureMaker, Watched, jpeg
from trecsim.values import Frame


@pytest.fixture
def made():
    """Return a picture maker with a clock that is moved by hand, and what it shows."""
    shown, clock = [], [0.0]

    def encode(frame):
        return f"{frame.camera} {frame.index}".encode()

    maker = PictureMaker(encode, lambda *picture: shown.append(picture), clock=lambda: clock[0])
    return maker, shown, clock


def frame(camera, index=0):
    return Frame(camera, index, 100.0 + index, np.zeros((4, 4, 3), np.uint8))


def test_nothing_is_made_of_a_camera_at_which_nobody_looks(made):
    maker, shown, _ = made
    maker.take(frame("north"))
    maker.look("south")
    maker.make()
    assert shown == []


def test_the_newest_image_is_shown_once_however_many_came(made):
    maker, shown, _ = made
    maker.look("north")
    for index in range(20):
        maker.take(frame("north", index))
    maker.make()
    maker.make()
    assert shown == [("north", 119.0, b"north 19")]


def test_who_does_not_ask_again_is_shown_nothing_more(made):
    maker, shown, clock = made
    maker.look("north")
    maker.take(frame("north", 1))
    clock[0] = LOOKS_S + 0.1
    maker.make()
    maker.take(frame("north", 2))
    maker.make()
    assert shown == []


def test_images_go_on_as_they_come(made):
    maker, shown, _ = made
    maker.look("north")
    images = [frame("north", index) for index in range(3)]
    assert list(Watched(images, maker.take)) == images
    maker.make()
    assert shown == [("north", 102.0, b"north 2")]


def test_a_picture_is_a_small_jpeg_of_the_image():
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("av")
    ramp = np.zeros((720, 1280, 3), np.uint8)
    ramp[..., 0] = np.linspace(0, 255, 1280, dtype=np.uint8)
    picture = image.open(io.BytesIO(jpeg(Frame("north", 0, 0.0, ramp))))
    assert (picture.format, picture.size) == ("JPEG", (640, 360))
    found = np.asarray(picture).astype(float)
    np.testing.assert_allclose(found[:, ::64, 0].mean(axis=0), ramp[0, ::128, 0], atol=8)
    assert found[..., 1:].mean() < 8
