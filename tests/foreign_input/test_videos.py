"""Videos that other people's recorders wrote."""

import pytest

from trecsim.sources import VideoFile


@pytest.fixture(scope="module")
def case(shared_data):
    return shared_data / "foreign_input"


@pytest.mark.parametrize("name", ["cam1.mkv", "cam2.ts"])
def test_a_whole_recording_of_one_image_a_second_gives_no_warning(name, case, caplog):
    assert len(list(VideoFile(case / "low-rate-mkv" / name, "cam"))) == 20
    assert caplog.messages == []


def test_the_picture_is_taken_and_not_the_preview(case, caplog):
    video = VideoFile(case / "two-video-tracks" / "cam1.mp4", "cam1")
    assert video.size_px == (640, 480)
    assert {frame.image.shape for frame in video} == {(480, 640, 3)}
    assert "the largest, 640 x 480 px, is read, not 160 x 120" in caplog.messages[0]
