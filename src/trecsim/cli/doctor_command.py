"""The command `trecsim doctor`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import finish, note
from trecsim.errors import SetupError

if TYPE_CHECKING:
    from trecsim.doctor import Finding


def doctor(site: Path | None = None, /, *, json: bool = False) -> None:
    """Check the installation, and the cameras of a site.

    Each line says what was found, and what to do if something is missing. Optional parts may be
    missing; the exit code is 1 if nothing would work, or if a camera of the site does not.

    Parameters
    ----------
    site
        A site file. Its live cameras are connected and looked at for up to 10 s: what they send, at
        what rate, how late, and whether they tell their clock; also the port of its page.
    json
        Print the findings as one JSON object.
    """
    from trecsim.doctor import examine

    findings = list(examine())
    if site is not None:
        findings += _site_findings(site)
    broken = [found.name for found in findings if found.essential and found.state != "ok"]
    finish({"healthy": not broken, "findings": findings}, json, _table(findings))
    if broken:
        raise SetupError(f"trecsim cannot work without: {', '.join(broken)}")


def _site_findings(path: Path) -> list["Finding"]:
    from trecsim.site_doctor import examine_site
    from trecsim.sites.check import check_site

    checked = check_site(path)
    for remark in checked.remarks:
        note(remark)
    return list(examine_site(checked))


def _table(findings: Sequence["Finding"]) -> str:
    width = max(len(found.name) for found in findings)
    lines = []
    for found in findings:
        lines.append(f"{found.state:8}{found.name:{width}}  {found.text}")
        if found.remedy:
            lines.append(f"{'':8}{'':{width}}  -> {found.remedy}")
    return "\n".join(lines)
