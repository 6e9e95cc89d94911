"""The page about alerts: its examples are right, and it names every kind of output."""

import re
from pathlib import Path
from typing import get_args

import pytest

from made_site import make_site
from trecsim.sites.output_tables import AnyOutput
from trecsim.sites.site_reading import read_site

PAGE = (Path(__file__).parents[2] / "docs" / "alerts.md").read_text()
EXAMPLES = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("example", EXAMPLES)
def test_each_example_is_part_of_a_site_file(tmp_path: Path, example: str) -> None:
    assert len(read_site(make_site(tmp_path, 2, example)).site.outputs) == 1


def test_every_kind_of_output_has_an_example() -> None:
    kinds = {
        get_args(one.model_fields["kind"].annotation)[0] for one in get_args(AnyOutput.__origin__)
    }
    assert {re.search(r'kind = "(\w+)"', one)[1] for one in EXAMPLES} == kinds  # type: ignore[index]


def test_the_receiver_of_the_page_is_python() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    compile(code, "alerts.md", "exec")


def test_it_says_that_alerts_are_advisory() -> None:
    assert "**Alerts are advisory.** trecsim is no certified safety function" in PAGE
