"""The command `trecsim doctor`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from trecsim.cli.terminal import finish
from trecsim.errors import SetupError

if TYPE_CHECKING:
    from trecsim.doctor import Finding


def doctor(*, json: bool = False) -> None:
    """Check the installation.

    Each line says what was found, and what to do if something is missing. Optional parts may be
    missing; the exit code is 1 only if nothing would work.

    Parameters
    ----------
    json
        Print the findings as one JSON object.
    """
    from trecsim.doctor import examine

    findings = list(examine())
    broken = [found.name for found in findings if found.essential and found.state != "ok"]
    finish({"healthy": not broken, "findings": findings}, json, _table(findings))
    if broken:
        raise SetupError(f"trecsim cannot work without: {', '.join(broken)}")


def _table(findings: Sequence["Finding"]) -> str:
    width = max(len(found.name) for found in findings)
    lines = []
    for found in findings:
        lines.append(f"{found.state:8}{found.name:{width}}  {found.text}")
        if found.remedy:
            lines.append(f"{'':8}{'':{width}}  -> {found.remedy}")
    return "\n".join(lines)
