"""What the service manager of the system hears."""

import os
import socket

import pytest

from trecsim.service.systemd import Heartbeat, notify


@pytest.fixture
def manager(tmp_path, monkeypatch):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "notify"))
        listener.setblocking(False)
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        yield listener


def heard(manager):
    messages = []
    while True:
        try:
            messages.append(manager.recv(4096).decode())
        except BlockingIOError:
            return messages


def test_it_hears_ready_once_and_that_the_work_goes_on_half_as_often_as_it_would_wait(
    manager, monkeypatch
):
    monkeypatch.setenv("WATCHDOG_USEC", "4000000")
    now_s = 0.0
    heartbeat = Heartbeat(lambda: now_s)
    for _ in range(100):
        heartbeat.beat()
        now_s += 0.1
    assert heard(manager) == ["READY=1", *["WATCHDOG=1"] * 5]


@pytest.mark.parametrize("variables", [{}, {"WATCHDOG_USEC": "4000000", "WATCHDOG_PID": "1"}])
def test_a_process_that_is_not_watched_says_only_that_it_is_ready(manager, monkeypatch, variables):
    assert os.getpid() != 1
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    heartbeat = Heartbeat(lambda: 0.0)
    heartbeat.beat()
    heartbeat.beat()
    assert heard(manager) == ["READY=1"]


@pytest.mark.parametrize("address", [None, "", "/nowhere/notify", "vsock:1:2"])
def test_without_a_service_manager_nothing_happens(monkeypatch, address):
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    if address is not None:
        monkeypatch.setenv("NOTIFY_SOCKET", address)
    notify("READY=1")
