"""Cameras that fail do so in every way, one at a time, and nothing else is changed."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import soak
from fusion.made import made, path
from harness.figures import leaves
from harness.options import Options
from trecsim.lab.simulation.scene import Simulation


@cache
def room() -> Simulation:
    """Return a minute of somebody who stands."""
    return made([path((0, 0.6, 0.4), (60, 0.6, 0.4))], cameras=3, seconds=60.0, fps=soak.FPS)


@pytest.fixture(scope="module")
def failing():
    """Return what arrived in a minute, and which camera had what trouble at each image."""
    stream = soak.Failing(np.random.default_rng(0))
    arrived = []
    for image in stream.images(room(), 60.0):
        troubles = {name: camera.trouble for name, camera in stream.cameras.items()}
        arrived.append((image, troubles))
    return arrived


def test_one_camera_fails_at_a_time(failing):
    assert max(sum(map(bool, troubles.values())) for _, troubles in failing) == soak.AT_ONCE
    assert len({what for _, troubles in failing for what in troubles.values() if what}) >= 2


def test_a_camera_fails_in_every_way():
    stream, seen = soak.Failing(np.random.default_rng(0)), set()
    for turn in range(300):
        for view in room().poses[::20]:
            stream.sent(view, view.t_s + 60.0 * turn)
            seen |= {camera.trouble for camera in stream.cameras.values()}
    assert seen == {"", *soak.TROUBLES}


def test_most_images_arrive_as_they_were_taken(failing):
    taken = {(view.camera, view.t_s): view for view in room().poses}
    as_taken = [
        image
        for image, _ in failing
        if (image.camera, image.t_s) in taken
        and image.xy_px is taken[image.camera, image.t_s].xy_px
    ]
    assert 0.5 < len(as_taken) / len(room().poses) < 0.95
    assert len(failing) < len(room().poses)


def test_a_camera_sends_its_images_in_order_of_arrival(failing):
    for camera in room().rig:
        arrivals = [
            image.t_s
            for image, troubles in failing
            if image.camera == camera.name and 0.0 <= image.t_s <= 60.0
            and troubles[camera.name] != "clock"
        ]  # fmt: skip
        back = sum(b < a for a, b in pairwise(arrivals))
        assert back <= 2  # where its clock came back


def test_following_a_minute_of_it_gives_all_figures_and_loses_nobody(monkeypatch):
    monkeypatch.setattr(soak, "calibration_ms", lambda: 1.0)  # it has to be compiled
    figures = dict(leaves(soak.follow(room(), 60.0, Options())))
    assert figures["faults", "exceptions"].value == 0
    assert figures["somebody who stands throughout", "identities"].value == 1
    assert figures["length", "frame sets"].value > 500
    assert all(np.isfinite(figure.value) for figure in figures.values())
