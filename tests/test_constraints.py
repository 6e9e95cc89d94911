"""The pinned versions satisfy what the package requires; otherwise `make` cannot install it."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PINNED = {
    canonicalize_name(name): version
    for name, version in re.findall(
        r"^([\w.-]+)==(\S+)", (ROOT / "constraints.txt").read_text(encoding="utf-8"), re.MULTILINE
    )
}


def requirements() -> list[Requirement]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    texts = [*project["dependencies"], *(text for extra in extras for text in extra)]
    found = [Requirement(text) for text in dict.fromkeys(texts)]
    return [one for one in found if one.name != project["name"]]  # an extra that names others


@pytest.mark.parametrize("requirement", requirements(), ids=str)
def test_the_package_accepts_the_pinned_version(requirement: Requirement) -> None:
    assert requirement.specifier.contains(
        PINNED[canonicalize_name(requirement.name)], prereleases=True
    )
