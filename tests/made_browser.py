"""A real Chromium that opens the page of a test, and what it complains about."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--mute-audio"]
PATIENCE_MS = 90_000  # 3D without a graphics card takes seconds a picture on a busy machine
BAD = ("error", "warning")
HARMLESS = ("GPU stall due to ReadPixels",)


@pytest.fixture(scope="session")
def chromium() -> Iterator[object]:
    """Start Chromium once for the tests of a process."""
    tool = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed; .ci/browser installs it")
    with tool.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@contextmanager
def opened(browser, url, *, width=1024, height=768, dark=False, expected=()):
    """Open a page; fail when it reports an error, a broken policy, or a request to elsewhere."""
    context = browser.new_context(
        viewport={"width": width, "height": height}, reduced_motion="reduce",
        color_scheme="dark" if dark else "light",
    )  # fmt: skip
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    complaints, elsewhere = [], []
    page.on("console", lambda m: complaints.append(m.text) if m.type in BAD else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    origin = "/".join(url.split("/")[:3])
    page.on(
        "request",
        lambda r: (
            None if r.url.removeprefix("blob:").startswith(origin) else elsewhere.append(r.url)
        ),
    )
    try:
        page.goto(url)
        yield page
    finally:
        context.close()  # else the page of a test that fails draws on, and slows down all others
    assert [
        text for text in complaints if not any(one in text for one in (*HARMLESS, *expected))
    ] == []
    assert elsewhere == []
