"""The page of a command: it listens first, and its address is a line of its own."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import note
from trecsim.errors import InputError, SetupError

if TYPE_CHECKING:
    from trecsim.page.page_data import PageData
    from trecsim.page.page_process import PageProcess
    from trecsim.page.site_view import SiteView


def tell_page(url: str, *, json: bool) -> None:
    """Print where the page is, at once; with --json on stderr, as stdout holds one object."""
    print(f"page: {url}", file=sys.stderr if json else sys.stdout, flush=True)


@contextmanager
def site_page(site: Path, out: Path | None, *, json: bool) -> Iterator["PageProcess | None"]:
    """Open the page of a site file before anything else is done; None if it has none.

    What is wrong with the file is left to those who check it all.

    Parameters
    ----------
    site
        The site file.
    out
        Directory of this run, if it is not where the site file says.
    json
        Whether stdout belongs to a JSON object.
    """
    from trecsim.service.viewing import page_of_site

    page = page_of_site(site, out)
    if page is None:
        yield None
        return
    with page:
        tell_page(page.url, json=json)
        yield page


def page_anywhere(view: "SiteView", data: "PageData", port: int | None) -> "PageProcess":
    """Return a page on this machine: at a port, or the usual one, or a free one if it is taken.

    Parameters
    ----------
    view
        What it shows.
    data
        Files it reads.
    port
        The port; None takes the usual one or a free one.

    Raises
    ------
    InputError
        It cannot listen there.
    SetupError
        Optional packages are missing.
    """
    from trecsim.page.address import PageAddress
    from trecsim.page.page_process import PageProcess

    if port is not None:
        return PageProcess(PageAddress(port=port), view, data)
    try:
        return PageProcess(PageAddress(), view, data)
    except InputError:  # the usual port is taken
        return PageProcess(PageAddress(port=0), view, data)


@contextmanager
def demo_page(folder: Path, *, json: bool) -> Iterator["PageProcess | None"]:
    """Open a page for a demo at the usual port or a free one; None where it cannot be.

    Parameters
    ----------
    folder
        Of the demo, ready.
    json
        Whether stdout belongs to a JSON object.
    """
    from trecsim.lab.demo_folder import RUN
    from trecsim.page.page_data import PageData
    from trecsim.page.site_view import SiteView

    data = PageData(folder, folder / RUN, folder / "site.toml")
    try:
        page = page_anywhere(SiteView("demo"), data, None)
    except SetupError as error:
        note(f"the demo runs without its page: {error}")
        yield None
        return
    with page:
        tell_page(page.url, json=json)
        yield page
