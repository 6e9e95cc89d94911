import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.errors import SetupError
from trecsim.estimators.letterbox import Letterbox, scale, scaled_size

cv2 = pytest.importorskip("cv2")

sides = st.integers(1, 5000)
sizes = st.tuples(sides, sides)


def boxes(image_px, other_px, long_side):
    return [
        Letterbox.along(image_px, long_side, 32),
        Letterbox.within(image_px, other_px),
        Letterbox.within(image_px, other_px, centred=False),
    ]


@given(sizes, sizes, st.integers(64, 2048))
def test_points_go_there_and_back(image_px, other_px, long_side):
    xy_px = np.array([[0.0, 0.0], [image_px[0] - 1.0, image_px[1] / 3], [-5.0, 7.5]])
    for box in boxes(image_px, other_px, long_side):
        np.testing.assert_allclose(box.to_image(box.to_input(xy_px)), xy_px, atol=1e-6)


@given(sizes, sizes, st.integers(64, 2048))
def test_the_borders_of_the_image_meet_those_of_its_place_in_the_input(image_px, other_px, long):
    for box in boxes(image_px, other_px, long):
        low = np.array(box.offset_px) - 0.5
        high = low + box.scaled_px
        np.testing.assert_allclose(box.to_image(low), [-0.5, -0.5], atol=1e-9)
        np.testing.assert_allclose(box.to_image(high), np.array(image_px) - 0.5, atol=1e-9)


@given(sizes, sizes, st.integers(64, 2048))
def test_the_scaled_image_lies_within_the_input(image_px, other_px, long_side):
    for box in boxes(image_px, other_px, long_side):
        assert (np.array(box.scaled_px) >= 1).all()
        assert (np.array(box.offset_px) >= 0).all()
        assert (np.add(box.offset_px, box.scaled_px) <= box.input_px).all()


@given(sizes, st.integers(64, 2048))
def test_the_longer_side_is_as_asked_and_the_input_as_divisible_as_asked(image_px, long_side):
    box = Letterbox.along(image_px, long_side, 64)
    assert max(box.scaled_px) == long_side
    assert box.input_px[0] % 64 == box.input_px[1] % 64 == 0
    assert max(box.input_px) < long_side + 64
    assert scaled_size(image_px, long_side) == box.scaled_px


def test_padding_is_centred_or_to_the_right_and_below():
    assert Letterbox.within((200, 100), (64, 64)).offset_px == (0, 16)
    assert Letterbox.within((200, 100), (64, 64), centred=False).offset_px == (0, 0)


def test_the_image_is_padded_with_the_grey_that_is_asked():
    image = np.full((50, 100, 3), 200, np.uint8)
    padded = Letterbox.within((100, 50), (64, 64)).apply(image, fill=7)
    assert padded.shape == (64, 64, 3)
    assert (padded[:16] == 7).all()
    assert (padded[-16:] == 7).all()
    np.testing.assert_allclose(padded[16:48], 200, atol=2)


def test_an_image_of_the_right_size_is_not_copied():
    image = np.zeros((64, 96, 3), np.uint8)
    assert Letterbox.along((96, 64), 96, 32).apply(image, fill=0) is image


def a_picture(width, height):
    x, y = np.meshgrid(np.linspace(0, 9, width), np.linspace(0, 5, height))
    channels = [np.sin(x) * np.cos(y), np.cos(x + y), np.sin(x - y)]
    return (127 + 100 * np.stack(channels, axis=-1)).astype(np.uint8)


@pytest.mark.parametrize("size_px", [(320, 180), (512, 288), (333, 187), (1280, 720)])
def test_scaling_agrees_with_the_reference(size_px):
    image = a_picture(960, 540)
    kind = cv2.INTER_AREA if size_px[0] < 960 else cv2.INTER_LINEAR
    difference = scale(image, size_px).astype(float) - cv2.resize(
        image, size_px, interpolation=kind
    )
    assert np.abs(difference).mean() < 1.5


@pytest.mark.parametrize("size_px", [(240, 135), (333, 187)])
def test_what_is_seen_keeps_its_place_when_scaled(size_px):
    image = np.zeros((540, 960, 3), np.uint8)
    image[300:340, 500:560] = 255  # centre at 529.5, 319.5
    box = Letterbox((960, 540), size_px, size_px)
    weight = scale(image, size_px)[..., 0].astype(float)
    y, x = np.mgrid[: size_px[1], : size_px[0]]
    centre = np.array([(x * weight).sum(), (y * weight).sum()]) / weight.sum()
    np.testing.assert_allclose(box.to_image(centre), [529.5, 319.5], atol=0.3)


def test_an_image_that_is_a_view_into_another_can_be_scaled():
    whole = a_picture(960, 540)
    part = whole[10:300:2, 20:500:3]
    np.testing.assert_array_equal(scale(part, (80, 70)), scale(part.copy(), (80, 70)))


def test_a_missing_pyav_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(SetupError, match=r"needs PyAV.*\[video\]"):
        scale(np.zeros((4, 4, 3), np.uint8), (2, 2))
