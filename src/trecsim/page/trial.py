"""Trials of drafts on recordings, each in a process of its own."""

import asyncio
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from starlette.exceptions import HTTPException

LONGEST_S = 120.0
"""A trial that takes longer is ended [s]."""
COMMAND = (sys.executable, "-m", "trecsim.trying")


@dataclass(frozen=True, slots=True)
class Trials:
    """Tries drafts, one at a time.

    Attributes
    ----------
    recordings
        The folder with the recordings of the site; None where there are none.
    """

    recordings: Path | None
    _turn: asyncio.Lock = field(default_factory=asyncio.Lock)

    async def run(
        self,
        site_file: Path,
        texts: Mapping[str, str],
        recording: Path,
        part_s: tuple[float, float],
    ) -> dict[str, Any]:
        """Return what `trecsim.trying.try_rules` finds.

        Parameters
        ----------
        site_file, texts, recording
            See there.
        part_s
            The part of the recording [s].

        Raises
        ------
        HTTPException
            Another trial runs; this one takes too long; or something in it is wrong.
        """
        if self._turn.locked():
            raise HTTPException(409, "another trial runs; try again when it is done")
        request = {
            "site_file": str(site_file),
            "texts": dict(texts),
            "recording": str(recording),
            "from_s": part_s[0],
            "to_s": part_s[1],
        }
        async with self._turn:
            answer = await _answer(json.dumps(request).encode())
        if "error" in answer:
            raise HTTPException(422, str(answer["error"]))
        return answer


async def _answer(request: bytes) -> dict[str, Any]:
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*COMMAND, stdin=pipe, stdout=pipe)
    try:
        out, _ = await asyncio.wait_for(process.communicate(request), LONGEST_S)
    except TimeoutError:
        raise HTTPException(
            503,
            f"the trial took longer than {LONGEST_S:g} s and was ended; choose a shorter part of "
            "the recording",
        ) from None
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    try:
        answer: dict[str, Any] = json.loads(out)
    except ValueError:
        raise HTTPException(503, "the trial failed; the log of the site says why") from None
    return answer
