"""Functions that callers pass in to follow a long task."""

from collections.abc import Callable

Progress = Callable[[int, int | None], None]
"""Called with the number of finished steps, and of all if it is known."""

Remark = Callable[[str], None]
"""Called with one line that the user should know, without an error."""
