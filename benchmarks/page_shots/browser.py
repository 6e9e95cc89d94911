"""Chromium that shows the page at a fixed time, told what a situation says."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlparse

from playwright.sync_api import Browser, Page, Route, sync_playwright

from page_shots.server import HOST, POLICY, Situation, answer, messages

CHROMIUM = "/usr/bin/chromium"
FLAGS = (
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
    "--mute-audio", "--force-color-profile=srgb",
)  # fmt: skip
PATIENCE_MS = 120_000  # 3D without a graphics card takes seconds a picture on a busy machine
# A stream that says everything at once, so that the page draws the last moment only.
_STREAM = """
  window.WebSocket = class {
    constructor() {
      if (window.hasSpoken) return;
      window.hasSpoken = true;
      setTimeout(() => {
        this.onopen?.();
        const said = %s;
        for (const data of said) this.onmessage?.({ data });
        if (%s) setInterval(() => this.onmessage?.({ data: said.at(-1) }), 1000);
      }, 300);
    }
    close() {}
  };
"""
_FLAT = """
  const plain = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return String(kind).startsWith("webgl") ? null : plain.call(this, kind, ...more);
  };
"""
SIZES = {"wide": (1440, 900, 1.0), "tablet": (1024, 768, 1.0), "phone": (390, 844, 2.0)}


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start Chromium without a screen."""
    with sync_playwright() as tool:
        browser = tool.chromium.launch(executable_path=CHROMIUM, headless=True, args=list(FLAGS))
        yield browser
        browser.close()


@contextmanager
def opened(
    browser: Browser, situation: Situation, address: str, *, size: str = "wide", dark: bool = False
) -> Iterator[tuple[Page, list[str]]]:
    """Open the page at an address; yield it with a list of the errors that it reports."""
    width, height, scale = SIZES[size]
    context = browser.new_context(
        viewport={"width": width, "height": height}, device_scale_factor=scale,
        color_scheme="dark" if dark else "light", reduced_motion="reduce",
        has_touch=size != "wide", locale="en-GB",
    )  # fmt: skip
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    errors: list[str] = []
    page.on("console", lambda m: errors.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.clock.set_fixed_time(situation.now_s)
    context.route("**/*", lambda route: _answer(route, situation))
    said = json.dumps(list(messages(situation)))
    goes_on = json.dumps(situation.messages == "all")
    context.add_init_script(_STREAM % (said, goes_on))
    if not situation.webgl:
        context.add_init_script(_FLAT)
    page.goto(HOST + address)
    yield page, errors
    context.close()


def _answer(route: Route, situation: Situation) -> None:
    status, kind, body = answer(situation, urlparse(route.request.url).path)
    headers = {"Content-Type": kind, "Content-Security-Policy": POLICY}
    route.fulfill(status=status, headers=headers, body=body)
