"""Damaged files of 2D poses give images or one clear message, with no more work than their size."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from often import often
from sources.made_poses import flat, made_poses, mmpose_frames, write_coco, write_openpose
from trecsim.errors import InputError
from trecsim.sources import json_stream, read_poses, strict_json
from trecsim.store.poses_writer import PosesWriter

NASTY = [
    *("", "-", "9", "NaN", "Infinity", "1e999", "null", "[", "]", "{", "}", "\n", '"', "true"),
    *(".", "é", " ", ",", ":", "0", "-1", "1e-300", "9" * 20, '"image_id"', "\\u0000"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("poses")
    images = [made_poses("cam1", i / 25, 1 + i % 2, i) for i in range(4)]
    write_coco(folder / "coco.json", images, 25)
    write_coco(folder / "names.json", images, 25, "{:06d}_cam1.jpg".format)
    (folder / "inferencer.json").write_text(json.dumps(mmpose_frames(images)))
    demo = {"meta_info": {"dataset_name": "coco"}, "instance_info": mmpose_frames(images)}
    (folder / "demo.json").write_text(json.dumps(demo))
    for image in images:
        write_openpose(folder / "cam1_json", image, f"cam1_{round(25 * image.t_s)}.json")
    with PosesWriter(folder / "walk.poses.jsonl") as writer:
        for image in images:
            writer.write(image)
    return folder


EACH = {
    "coco.json": None,
    "names.json": None,
    "inferencer.json": None,
    "demo.json": None,
    "cam1_json/cam1_2.json": "cam1_json",
    "walk.poses.jsonl": None,
}


@pytest.mark.parametrize("name", EACH)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 4))
@settings(max_examples=often(60))
def test_a_damaged_file_gives_images_or_a_clear_message(name, seed, count, folder):
    rng = np.random.default_rng(seed)
    path = folder / name
    whole = text = path.read_text()
    for _ in range(count):
        start = int(rng.integers(len(text)))
        end = start + int(rng.integers(0, 12))
        text = text[:start] + str(rng.choice(NASTY)) + text[end:]
    path.write_text(text)
    try:
        images = list(read_poses(folder / (EACH[name] or name), fps=25))
    except InputError as error:
        assert 10 < len(str(error)) < 6000  # noqa: PT017
    else:
        assert all(np.isfinite(image.t_s) for image in images)
        assert all(((image.score >= 0) & (image.score <= 1)).all() for image in images)
        assert all((np.isfinite(image.xy_px).all(2) == (image.score > 0)).all() for image in images)
    finally:
        path.write_text(whole)


def test_a_long_file_is_parsed_once(tmp_path, monkeypatch):
    image = made_poses("a", 0.0, 1)
    entries = [
        {"image_id": index, "keypoints": flat(image, 0), "score": 1} for index in range(2000)
    ]
    (tmp_path / "a.json").write_text(json.dumps(entries))
    monkeypatch.setattr(json_stream, "CHUNK_CHARS", 10_000)
    calls = []
    original = strict_json.next_value
    monkeypatch.setattr(
        strict_json,
        "next_value",
        lambda *given, **more: calls.append(1) or original(*given, **more),
    )
    assert len(list(read_poses(tmp_path / "a.json", fps=25))) == 2000
    pieces = (tmp_path / "a.json").stat().st_size / 10_000
    assert len(calls) < 2000 + 2 * pieces


@pytest.mark.parametrize(
    "text", ["[" + "," * 10**6, "[" + " " * 10**6, '[{"a":' * 10**5, "[1" + "1" * 10**6]
)
def test_nonsense_without_end_is_looked_at_a_bounded_number_of_times(text, tmp_path, monkeypatch):
    (tmp_path / "a.json").write_text(text)
    calls = []
    original = strict_json.next_value
    monkeypatch.setattr(
        strict_json,
        "next_value",
        lambda *given, **more: calls.append(1) or original(*given, **more),
    )
    with pytest.raises(InputError):
        list(read_poses(tmp_path / "a.json", fps=25))
    assert len(calls) <= 1 + len(text) / json_stream.CHUNK_CHARS
