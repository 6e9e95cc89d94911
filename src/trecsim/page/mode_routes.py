"""`/api/mode`: which mode is in force, which rules are off by hand, and until when."""

import asyncio
import time
from collections.abc import Mapping
from typing import Annotated, Any
from zoneinfo import ZoneInfo

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from trecsim.page.access import Access, Identity
from trecsim.page.answers import json_answer
from trecsim.page.asking import Ask
from trecsim.page.bodies import body_of
from trecsim.page.journal import Journal
from trecsim.page.live_state import LiveState
from trecsim.safety.modes import LONGEST_S, Mode, Overrides, in_force, rules_off, scheduled
from trecsim.safety.schedules import local_time, read_hours

_Text = Annotated[str, msgspec.Meta(min_length=1, max_length=64)]


class BypassAsked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """That a rule is to be off until a time; without a time it is armed again."""

    rule: _Text
    until_s: float | None = None
    note: Annotated[str, msgspec.Meta(max_length=2000)] = ""


class ModeAsked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """What is to change: the mode, or a rule.

    Attributes
    ----------
    mode
        A mode of the site file; "" arms all rules; None goes back to the schedules.
    until_s
        Until when, Unix time [s]; 8 h from now at most.
    bypass
        A rule that is to be off, or armed again.
    """

    mode: str | msgspec.UnsetType | None = msgspec.UNSET
    until_s: float | None = None
    bypass: BypassAsked | None = None


def mode_routes(access: Access, state: LiveState, journal: Journal, ask: Ask) -> list[Route]:
    """Return the routes of modes.

    Parameters
    ----------
    access
        Says who may do what.
    state
        Knows the site.
    journal
        Keeps what people put in place.
    ask
        Tells the tracking process.
    """
    changing = asyncio.Lock()

    async def told(request: Request) -> Response:
        return json_answer(body_of_modes(state.site["site"], await journal.overrides(), _now_s()))

    async def change(request: Request) -> Response:
        identity: Identity = request.state.identity
        given = await body_of(request, ModeAsked)
        site = state.site["site"]
        _check(given, site)
        async with changing:
            now_s = _now_s()
            overrides = (await journal.overrides()).at(now_s)
            if given.mode is not msgspec.UNSET:
                overrides = overrides.choose(
                    given.mode or None, given.until_s, identity.by, now_s, ends=given.mode is None
                )
            if given.bypass is not None:
                asked = given.bypass
                overrides = overrides.bypass(
                    asked.rule, asked.until_s, identity.by, asked.note, now_s
                )
            await journal.keep_overrides(identity.by, overrides, msgspec.to_builtins(given))
        await ask("mode", identity.by, overrides.to_json())
        return json_answer(body_of_modes(site, overrides, now_s))

    return [
        Route("/api/mode", access.needs("viewer", told), methods=["GET"]),
        Route("/api/mode", access.needs("operator", change), methods=["POST", "PUT"]),
    ]


def _now_s() -> float:
    return time.time()


def _check(given: ModeAsked, site: Mapping[str, Any]) -> None:
    """Refuse what changes nothing, or names what is not there."""
    if site.get("kind") == "recording":
        raise HTTPException(409, "a recording has no mode: its rules are not judged now")
    if given.mode is msgspec.UNSET and given.bypass is None:
        raise HTTPException(400, "expected a mode or a bypass, found neither")
    if isinstance(given.mode, str) and given.mode and given.mode not in site.get("modes", {}):
        known = ", ".join(site.get("modes", {})) or "none"
        raise HTTPException(
            400, f"there is no mode {given.mode!r} in the site file; it has {known}"
        )
    if given.bypass is not None and given.bypass.rule not in site.get("rule_ids", ()):
        raise HTTPException(400, f"there is no rule {given.bypass.rule!r} in the site file")
    for until_s in (given.until_s, given.bypass.until_s if given.bypass else None):
        if until_s is not None and until_s <= _now_s():
            raise HTTPException(
                400, "expected a time to come as until_s, found one that has passed"
            )


def body_of_modes(site: Mapping[str, Any], overrides: Overrides, now_s: float) -> dict[str, Any]:
    """Return the body of `/api/mode`.

    Parameters
    ----------
    site
        The site as `/api/site` shows it.
    overrides
        What people have put in place.
    now_s
        The present, Unix time [s].
    """
    modes = [
        Mode(
            name,
            None if one["schedule"] is None else tuple(map(read_hours, one["schedule"])),
            frozenset(one["off"]),
        )
        for name, one in site.get("modes", {}).items()
    ]
    now = local_time(now_s, ZoneInfo(site.get("timezone", "UTC")))
    current = overrides.at(now_s)
    mode, planned = in_force(modes, current, now), scheduled(modes, now)
    return {
        "mode": None if mode is None else mode.name,
        "scheduled": None if planned is None else planned.name,
        **current.to_json(),
        "off": sorted(rules_off(modes, current, now)),
        "modes": site.get("modes", {}),
        "longest_s": LONGEST_S,
    }
