"""How often a test tries what is drawn by chance."""

from hypothesis import settings

NIGHTLY = 100  # examples of a property that says nothing else, in nightly runs
DAILY = 12  # and in others: they are the same in every run, so that more of them find little
LEAST = 3  # examples at least, where a test asks for as many


def is_nightly() -> bool:
    """Tell whether this is `make test-random`, which may take its time."""
    return settings.default.max_examples >= NIGHTLY


def often(count: int) -> int:
    """Return `count` in nightly runs (`make test-random`), in others an eighth, or `LEAST`."""
    return max(-(-count * settings.default.max_examples // NIGHTLY), min(count, LEAST))
