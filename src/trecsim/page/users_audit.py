"""Changes of the file of users, told to the audit log."""

import asyncio
from collections.abc import Mapping

from trecsim.page.journal import Journal
from trecsim.page.users_file import User


class UsersAudit:
    """Writes into the audit log who came, went, or got another role or password.

    Parameters
    ----------
    journal
        Keeps the audit log.
    """

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._tasks: set[asyncio.Task[None]] = set()

    def __call__(self, before: Mapping[str, User], after: Mapping[str, User]) -> None:
        """Tell what has changed."""
        both = before.keys() & after.keys()
        changes = {
            "added": sorted(after.keys() - before.keys()),
            "removed": sorted(before.keys() - after.keys()),
            "roles": {
                name: after[name].role
                for name in sorted(both)
                if before[name].role != after[name].role
            },
            "passwords": sorted(
                name for name in both if before[name].password != after[name].password
            ),
        }
        entry = self._journal.audit("trecsim", "users changed", changes)
        task = asyncio.get_running_loop().create_task(entry)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
