"""Privacy masks blank what they cover, at any size, in recordings and live images."""

import numpy as np
import pytest

from made_videos import write_video
from trecsim.sources import VideoFile
from trecsim.sources.masks import Mask

WHITE = np.full((48, 64, 3), 200, np.uint8)
LEFT_HALF = [[(0, 0), (32, 0), (32, 48), (0, 48)]]


def test_a_mask_blanks_the_same_part_at_every_size():
    mask = Mask(LEFT_HALF, (64, 48))
    for image in (WHITE, WHITE[::2, ::2], np.repeat(WHITE, 2, axis=1)):
        blanked = mask(image)
        half = image.shape[1] // 2
        assert (blanked[:, :half] == 0).all()
        assert (blanked[:, half:] == image[:, half:]).all()
        assert (image == 200).all()  # whoever gave it keeps it


def test_several_polygons_are_blanked_where_any_covers():
    triangle = [(0, 0), (64, 0), (0, 48)]
    blanked = Mask([triangle, *LEFT_HALF], (64, 48))(WHITE)[..., 0]
    assert blanked[2, 50] == 0  # in the triangle
    assert blanked[45, 5] == 0  # in the half
    assert blanked[45, 60] == 200


@pytest.mark.parametrize("corners", [[(10, 10), (10, 10), (10, 10)], [(70, 0), (90, 0), (90, 9)]])
def test_a_polygon_without_area_or_outside_the_image_blanks_nothing(corners):
    assert (Mask([corners], (64, 48))(WHITE) == WHITE).all()


@pytest.mark.parametrize("limit_px", [None, (32, 32)])
def test_a_video_comes_with_its_mask(tmp_path, limit_px):
    path = write_video(tmp_path / "north.mp4", [WHITE] * 3)
    (image, *_) = [
        frame.image for frame in VideoFile(path, "n", decode_size_px=limit_px, mask_px=LEFT_HALF)
    ]
    half = image.shape[1] // 2
    assert image[:, :half].max() == 0
    assert image[:, half + 1 :].min() > 150


def test_a_live_image_is_masked_before_anybody_gets_it():
    av = pytest.importorskip("av")
    from trecsim.sources.streams.live_frame import Developer

    picture = av.VideoFrame.from_ndarray(WHITE, format="rgb24")
    image = Developer((32, 32), Mask(LEFT_HALF, (64, 48)))(picture)
    assert image.shape == (24, 32, 3)
    assert image[:, :16].max() == 0
    assert image[:, 17:].min() > 150
