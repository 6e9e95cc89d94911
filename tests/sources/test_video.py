import logging
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest

from made_videos import numbered, write_sound, write_tracks, write_video
from trecsim.errors import InputError, SetupError
from trecsim.sources import VideoFile, probe
from trecsim.sources.decoding import check_size


@pytest.fixture
def video(tmp_path):
    return write_video(tmp_path / "north.mp4", numbered(50))


def times_s(path, **kwargs):
    return [frame.t_s for frame in VideoFile(path, "north", **kwargs)]


def test_frames_come_in_order_with_name_number_time_and_picture(video):
    frames = list(VideoFile(video, "north"))
    assert [frame.camera for frame in frames] == ["north"] * 50
    assert [frame.index for frame in frames] == list(range(50))
    np.testing.assert_allclose([frame.t_s for frame in frames], np.arange(50) / 25.0)
    for frame, made in zip(frames, numbered(50), strict=True):
        assert frame.image.shape == (48, 64, 3)
        assert frame.image.dtype == np.uint8
        np.testing.assert_allclose(frame.image, made, atol=6)


def test_a_video_tells_size_rate_count_length_and_codec(video):
    info = probe(video)
    assert (info.size_px, info.fps, info.frame_count) == ((64, 48), 25.0, 50)
    assert (info.start_s, info.duration_s, info.codec) == (0.0, 2.0, "h264")
    assert info.expected_frames == 50


def test_a_video_can_be_read_again_and_twice_at_once(video):
    source = VideoFile(video, "north", threads=1)
    pairs = list(zip(source, source, strict=True))
    assert len(pairs) == 50
    assert all(np.array_equal(a.image, b.image) for a, b in pairs)


@pytest.mark.parametrize("threads", [1, 2, None])
def test_the_number_of_threads_does_not_change_the_pictures(video, threads):
    one = list(VideoFile(video, "north", threads=1))
    other = list(VideoFile(video, "north", threads=threads))
    assert all(np.array_equal(a.image, b.image) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize(
    ("name", "options", "fewest"),
    [
        ("a.mp4", {"b_frames": 2}, 8),
        ("a.mkv", {"codec": "mjpeg"}, 25),
        ("a.mp4", {"codec": "mpeg4"}, 0),
    ],
)
def test_images_that_nobody_needs_are_not_decoded_and_the_others_are_the_same(
    tmp_path, name, options, fewest
):
    video = VideoFile(write_video(tmp_path / name, numbered(50), **options), "a", threads=1)
    needed_s = 1.02
    found = list(video.pictures(needed_from=lambda: needed_s))
    every = list(video)
    assert [(one.index, one.t_s) for one in found] == [(one.index, one.t_s) for one in every]
    assert sum(one.to_rgb is None for one in found) >= fewest
    for one, other in zip(found, every, strict=True):
        assert one.to_rgb is not None or one.t_s < needed_s
        if one.to_rgb is not None:
            np.testing.assert_array_equal(one.frame().image, other.image)


@pytest.mark.parametrize("suffix", [".mp4", ".mkv", ".mov", ".ts"])
def test_b_frames_come_in_the_order_of_showing(tmp_path, suffix):
    path = write_video(tmp_path / f"a{suffix}", numbered(30), b_frames=2)
    frames = list(VideoFile(path, "a"))
    steps_s = np.diff([frame.t_s for frame in frames])
    np.testing.assert_allclose(steps_s, 0.04, atol=0.001)
    assert (np.diff([frame.image.mean() for frame in frames]) > 0).all()


def test_times_of_a_variable_frame_rate_are_kept(tmp_path):
    t_ms = [0, 10, 50, 60, 200, 1000, 1033]
    path = write_video(tmp_path / "phone.mkv", numbered(7), t_ms=t_ms)
    np.testing.assert_allclose(times_s(path), np.array(t_ms) / 1000.0)


def test_a_start_other_than_zero_is_kept(tmp_path):
    path = write_video(
        tmp_path / "late.ts", numbered(20), t_ms=[10_000 + 40 * i for i in range(20)]
    )
    np.testing.assert_allclose(times_s(path), 10.0 + 0.04 * np.arange(20))
    assert probe(path).start_s == pytest.approx(10.0)


def test_frames_without_a_time_go_on_at_the_rate_with_a_remark(tmp_path, caplog):
    path = write_video(tmp_path / "raw.h264", numbered(20), container="h264", b_frames=2)
    with caplog.at_level(logging.WARNING):
        np.testing.assert_allclose(times_s(path), np.arange(20) / 25.0)
    (message,) = caplog.messages
    assert "20 frames carry no time" in message


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv", "a.ts", "a.avi", "late.mp4"])
def test_from_a_later_time_on_come_the_same_pictures(name, tmp_path, caplog):
    start_ms = 10_000 if name.startswith("late") else 0
    t_ms = None if name.endswith(".avi") else [start_ms + 40 * number for number in range(250)]
    path = write_video(tmp_path / name, numbered(250), t_ms=t_ms, b_frames=2)
    video = VideoFile(path, "cam")
    whole = {round(picture.t_s, 3): picture.frame().image for picture in video.pictures()}
    from_s = start_ms / 1000 + 7.5
    late = {round(picture.t_s, 3): picture.frame().image for picture in video.pictures(from_s)}
    wanted = [t_s for t_s in whole if t_s >= from_s]
    assert [t_s for t_s in late if t_s >= from_s] == wanted
    assert all(np.array_equal(late[t_s], whole[t_s]) for t_s in late)
    if not name.endswith((".avi", ".ts")):  # without an index, read from the beginning
        assert len(wanted) < len(late) < len(wanted) + 25
    assert not caplog.records


def test_avi_counts_its_frames_and_so_do_we(tmp_path, caplog):
    path = write_video(tmp_path / "old.avi", numbered(20), b_frames=2)
    with caplog.at_level(logging.WARNING):
        np.testing.assert_allclose(times_s(path), np.arange(20) / 25.0)
    assert caplog.messages == []


def test_frames_whose_time_does_not_advance_are_left_out_with_a_remark(tmp_path, caplog):
    first = write_video(tmp_path / "1.ts", numbered(20), codec="mpeg2video")
    spliced = tmp_path / "spliced.ts"
    spliced.write_bytes(first.read_bytes() * 2)
    with caplog.at_level(logging.WARNING):
        t_s = times_s(spliced)
    assert (np.diff(t_s) > 0).all()
    assert len(t_s) == 20
    assert any("20 frames are left out" in message for message in caplog.messages)


def bright_corner():
    image = np.zeros((96, 128, 3), np.uint8)
    image[:32, :48] = 255  # top left, wider than high
    return image


@pytest.mark.parametrize(
    ("rotated_deg", "size_px", "corner"),
    [
        (0, (128, 96), (slice(0, 32), slice(0, 48))),
        (90, (96, 128), (slice(80, 128), slice(0, 32))),
        (180, (128, 96), (slice(64, 96), slice(80, 128))),
        (-90, (96, 128), (slice(0, 48), slice(64, 96))),
    ],
)
def test_a_picture_marked_as_turned_comes_upright(tmp_path, rotated_deg, size_px, corner):
    path = write_video(tmp_path / "p.mp4", [bright_corner()] * 3, rotated_deg=rotated_deg)
    source = VideoFile(path, "phone")
    assert source.size_px == size_px
    for frame in source:
        expected = np.zeros((*size_px[::-1], 3), np.uint8)
        expected[corner] = 255
        assert np.abs(frame.image.astype(float) - expected).mean() < 3.0
        assert frame.image.flags.c_contiguous


def spot(x, y, size_px):
    """Return an image with one soft bright spot around x, y."""
    columns, rows = np.meshgrid(np.arange(size_px[0]), np.arange(size_px[1]))
    value = 255.0 * np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / (2 * 8.0**2))
    return np.repeat(value[..., None], 3, axis=2).astype(np.uint8)


def centre_px(image):
    weight = image.astype(float).sum(axis=2)
    rows, columns = np.indices(weight.shape)
    return np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()


@pytest.mark.parametrize("rotated_deg", [0, 90])
@pytest.mark.parametrize("limit_px", [(80, 80), (100, 1000), (1000, 33), (97, 97)])
def test_points_of_a_smaller_image_map_back_to_the_original(tmp_path, rotated_deg, limit_px):
    path = write_video(
        tmp_path / "s.mp4", [spot(70.0, 50.0, (320, 240))] * 2, rotated_deg=rotated_deg
    )
    full = VideoFile(path, "a")
    small = VideoFile(path, "a", decode_size_px=limit_px)
    expected = centre_px(next(iter(full)).image)
    image = next(iter(small)).image
    assert image.shape[1::-1] == small.decoded_size_px
    assert all(np.array(small.decoded_size_px) <= limit_px)
    np.testing.assert_allclose(small.original_px(centre_px(image)), expected, atol=0.25)


def test_images_are_never_enlarged_and_keep_their_shape(video):
    assert VideoFile(video, "a", decode_size_px=(999, 999)).decoded_size_px == (64, 48)
    assert VideoFile(video, "a", decode_size_px=(32, 999)).decoded_size_px == (32, 24)
    assert VideoFile(video, "a", decode_size_px=(1, 1)).decoded_size_px == (1, 1)


@pytest.mark.parametrize("container", [".mp4", ".mkv"])
def test_what_comes_before_a_cut_is_kept_with_one_warning(tmp_path, container, caplog):
    whole = write_video(
        tmp_path / f"w{container}",
        np.random.default_rng(0).integers(0, 255, (75, 48, 64, 3), np.uint8),
        options={"movflags": "faststart"} if container == ".mp4" else None,
    )
    data = whole.read_bytes()
    cut = tmp_path / f"cut{container}"
    cut.write_bytes(data[: len(data) * 6 // 10])
    with caplog.at_level(logging.WARNING):
        frames = list(VideoFile(cut, "a"))
    assert 35 <= len(frames) <= 50
    (message,) = caplog.messages
    assert str(cut) in message
    assert f" {len(frames)} " in message
    assert "cut off" in message


def test_damage_in_the_middle_costs_only_what_is_damaged(tmp_path, caplog):
    whole = write_video(tmp_path / "w.mp4", numbered(75), codec="mjpeg")
    data = bytearray(whole.read_bytes())
    start = data.index(b"mdat") + 4 + (len(data) - data.index(b"mdat")) // 2
    data[start : start + 3000] = bytes(3000)
    hurt = tmp_path / "hurt.mp4"
    hurt.write_bytes(data)
    with caplog.at_level(logging.WARNING):
        frames = list(VideoFile(hurt, "a"))
    assert 50 <= len(frames) < 75
    assert frames[-1].t_s == pytest.approx(74 / 25)
    (message,) = caplog.messages
    assert f"{len(frames)} of 75 frames" in message


def test_a_whole_video_gives_no_warning(video, caplog):
    with caplog.at_level(logging.WARNING):
        assert len(list(VideoFile(video, "a"))) == 50
    assert caplog.messages == []


def refused(path):
    with pytest.raises(InputError) as caught:
        VideoFile(path, "north")
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    assert "no such file" in refused(tmp_path / "none.mp4")


def test_a_folder_is_no_video(tmp_path):
    assert "folder" in refused(tmp_path)


def test_an_empty_file_is_named_empty(tmp_path):
    (tmp_path / "empty.mp4").touch()
    assert "empty" in refused(tmp_path / "empty.mp4")


def test_a_file_with_sound_only_is_told_from_a_video(tmp_path):
    assert "no video in it, only audio" in refused(write_sound(tmp_path / "sound.mp4"))


@pytest.mark.parametrize("name", ["note.txt", "note.mp4", "note.jpg"])
def test_a_text_is_no_video(tmp_path, name):
    (tmp_path / name).write_text("hello world\n" * 100)
    assert "no video" in refused(tmp_path / name)


def test_noise_is_no_video(tmp_path):
    (tmp_path / "a.mkv").write_bytes(np.random.default_rng(1).bytes(20_000))
    assert "no video" in refused(tmp_path / "a.mkv")


def test_a_recording_cut_before_its_index_was_written_is_refused(video):
    video.write_bytes(video.read_bytes()[:1500])
    assert "cut off" in refused(video)


def test_an_unknown_coding_is_named_as_such(video):
    video.write_bytes(video.read_bytes().replace(b"avc1", b"zz99"))
    assert "coding" in refused(video)


def test_a_video_without_a_readable_frame_is_refused(tmp_path):
    path = write_video(tmp_path / "a.mp4", numbered(9), options={"movflags": "faststart"})
    data = path.read_bytes()
    start = data.index(b"mdat") + 4
    path.write_bytes(data[:start] + bytes(len(data) - start))
    assert "no image in it can be decoded" in refused(path)


def test_a_playlist_is_not_followed_to_other_files(video, tmp_path):
    playlist = tmp_path / "list.m3u8"
    playlist.write_text(f"#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:1,\n{video.name}\n")
    assert "no video" in refused(playlist)
    script = tmp_path / "list.ffconcat"
    script.write_text(f"ffconcat version 1.0\nfile {video.name}\n")
    assert "no video" in refused(script)


def test_a_name_with_colon_percent_and_space_is_a_name(video, tmp_path):
    path = video.rename(tmp_path / "concat:a %03d|b.mp4")
    assert len(list(VideoFile(path, "a"))) == 50


def test_images_that_would_not_fit_into_memory_are_refused(tmp_path):
    with pytest.raises(InputError, match="100000 x 100000"):
        check_size(tmp_path / "huge.mp4", 100_000, 100_000)


def test_a_change_of_the_image_size_is_refused(tmp_path):
    small = write_video(tmp_path / "1.ts", numbered(20))
    large = write_video(
        tmp_path / "2.ts",
        numbered(20, (128, 96)),
        t_ms=[2000 + 40 * i for i in range(20)],
    )
    spliced = tmp_path / "spliced.ts"
    spliced.write_bytes(small.read_bytes() + large.read_bytes())
    frames = []
    with pytest.raises(InputError, match="from 64 x 48 to 128 x 96 px"):
        frames.extend(VideoFile(spliced, "a"))


def test_without_pyav_the_message_says_what_to_install(video, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.delitem(sys.modules, "trecsim.sources.decoding")
    monkeypatch.delattr("trecsim.sources.decoding")
    with pytest.raises(SetupError, match=r"\[video\]"):
        VideoFile(video, "north")


def test_frames_that_were_taken_are_not_held_any_longer(tmp_path):
    path = write_video(tmp_path / "long.mp4", numbered(200))
    images = []
    for frame in VideoFile(path, "a"):
        images.append(weakref.ref(frame.image))
        assert sum(image() is not None for image in images) <= 2
    assert len(images) == 200


def test_closing_early_closes_the_file(video):
    frames = iter(VideoFile(video, "a"))
    next(frames)
    frames.close()
    with pytest.raises(StopIteration):
        next(frames)


def test_real_recordings_come_whole(shared_data):
    folder = shared_data / "pose2sim_demo" / "MultiPerson" / "videos"
    if not folder.is_dir():
        pytest.skip("pose2sim_demo is not there")
    for path in sorted(folder.glob("*.mp4")):
        source = VideoFile(path, path.stem, decode_size_px=(512, 512))
        assert source.size_px == (1088, 1920)
        frames = list(source)
        np.testing.assert_allclose([frame.t_s for frame in frames], np.arange(100) / 60.0)
        assert frames[0].image.shape == (512, 290, 3)


@pytest.mark.parametrize("sizes_px", [[(32, 24), (64, 48)], [(64, 48), (32, 24), (48, 36)]])
def test_of_several_video_tracks_the_largest_is_read_with_a_remark(tmp_path, sizes_px, caplog):
    video = VideoFile(write_tracks(tmp_path / "cam1.mp4", sizes_px), "cam1")
    assert [frame.image.shape for frame in video] == [(48, 64, 3)] * 5
    (message,) = caplog.messages
    assert "has several video tracks: the largest, 64 x 48 px, is read, not" in message


def test_a_caller_that_takes_the_remark_on_a_file_finds_it_in_no_log(tmp_path, caplog):
    told = []
    path = write_tracks(tmp_path / "cam1.mp4", [(32, 24), (64, 48)])
    VideoFile(path, "cam1", remark=told.append)
    assert ["has several video tracks" in text for text in told] == [True]
    assert not caplog.messages


@pytest.mark.parametrize("suffix", [".mkv", ".ts"])
@pytest.mark.parametrize("step_ms", [1000, 2000])
def test_a_whole_recording_of_an_image_a_second_or_less_is_not_called_cut_off(
    tmp_path, suffix, step_ms, caplog
):
    times = [step_ms * index for index in range(12)]
    path = write_video(tmp_path / f"cam1{suffix}", numbered(12), t_ms=times)
    assert len(list(VideoFile(path, "cam1"))) == 12
    assert caplog.messages == []


@pytest.mark.parametrize("name", ["a.jpg", "frame_0001.PNG", "a.gif"])
def test_an_image_is_told_from_a_video(tmp_path, name):
    (tmp_path / name).write_bytes(b"\xff\xd8\xff")
    with pytest.raises(
        InputError, match="it is an image and no video; sequences of images are not read"
    ):
        VideoFile(tmp_path / name, "a")


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("rtsp://admin:pw@10.0.0.12:554/stream1", "rtsp://***@10.0.0.12:554/stream1"),
        ("http://10.0.0.12/cam", "http://10.0.0.12/cam"),
        ("/dev/video0", "/dev/video0"),
    ],
)
def test_a_live_stream_is_told_from_a_file_without_its_password(given, shown):
    with pytest.raises(InputError) as caught:
        VideoFile(Path(given), "a")
    assert str(caught.value) == (
        f"cannot read video {shown}: it is a live camera; `trecsim run` reads those, with a site "
        "file"
    )
