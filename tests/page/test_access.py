"""The operator page for everybody: axe's rules, the keyboard, old browsers, before scripts run."""

import pytest

from made_browser import PATIENCE_MS, opened
from made_hall import SITE, Tracking
from made_page import running_page
from trecsim.page.bundle import STATIC

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect
axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed")

pytestmark = pytest.mark.skipif(
    not (STATIC / "index.html").is_file(), reason="the page is not built; make page builds it"
)


@pytest.fixture(scope="module")
def url():
    with running_page(site=SITE) as page, Tracking(page).running() as tracking:
        tracking.silent = "cam1"
        tracking.event("new", 1e9)
        yield page.process.url


def faults(page) -> list[str]:
    found = axe.Axe().run(page).response["violations"]
    return [f"{one['id']}: {node['html'][:200]}" for one in found for node in one["nodes"]]


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_no_part_of_the_page_breaks_a_rule_of_axe(chromium, url, dark) -> None:
    with opened(chromium, f"{url}live?view=plan&p=3", dark=dark, width=1440, height=900) as page:
        page.wait_for_selector(".card")
        page.wait_for_selector(".selection dl")
        assert faults(page) == []
        page.keyboard.press("?")
        page.wait_for_selector("dialog[open]")
        assert faults(page) == []
        page.keyboard.press("Escape")
        for key, shown in (("2", ".review .item"), ("3", ".zones .item"), ("4", ".system .fault")):
            page.keyboard.press(f"Alt+{key}")
            page.wait_for_selector(shown)
            assert faults(page) == []


def test_a_dialog_keeps_the_focus_and_gives_it_back(chromium, url) -> None:
    with opened(chromium, f"{url}live?view=plan") as page:
        page.wait_for_selector(".card")
        help_button = page.get_by_role("button", name="Help")
        help_button.focus()
        page.keyboard.press("Enter")
        page.wait_for_selector("dialog[open]")
        for _ in range(4):
            page.keyboard.press("Tab")
            # Between its last and its first element the focus is at the browser's own.
            assert page.evaluate(
                "document.activeElement === document.body "
                "|| document.activeElement.closest('dialog') !== null"
            )
        page.keyboard.press("Escape")
        expect(help_button).to_be_focused(timeout=PATIENCE_MS)
        assert page.locator("dialog").count() == 0


def test_what_is_typed_into_the_form_of_a_card_is_text_and_no_keys(chromium, url) -> None:
    with opened(chromium, f"{url}live?view=plan") as page:
        page.locator(".card").get_by_role("button", name="More").click()
        page.get_by_role("button", name="Shelve").click()
        expect(page.get_by_label("Why")).to_be_focused(timeout=PATIENCE_MS)
        page.keyboard.type("an agent")
        assert page.get_by_label("Why").input_value() == "an agent"
        assert page.locator(".card").get_attribute("data-handling") == "new"
        assert page.locator(".menu").count() == 0
        page.keyboard.press("Escape")
        expect(page.locator(".card form")).to_have_count(0)


def test_a_browser_that_understands_no_script_of_the_page_is_told_so(chromium, url) -> None:
    refused = ("SyntaxError", "Unexpected", "Invalid")
    with opened(chromium, url, expected=refused) as page:
        page.route(
            "**/assets/*.js",
            lambda route: route.fulfill(
                content_type="text/javascript", body="a syntax of tomorrow"
            ),
        )
        page.reload()
        heading = page.locator(".status h1")
        heading.get_by_text("This browser is too old").wait_for(timeout=PATIENCE_MS)


def test_something_stands_there_before_any_script_has_run(chromium, url) -> None:
    context = chromium.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(url)
    assert page.inner_text(".status h1") == "Connecting…"
    assert "needs JavaScript" in page.inner_text(".status p")
    context.close()
