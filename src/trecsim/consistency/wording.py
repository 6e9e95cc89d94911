"""How cameras, times and shares read in a remark."""

from collections.abc import Sequence

LISTED = 6  # cameras; of more, the rest is counted


def cameras(names: Sequence[str], total: int) -> str:
    """Return cameras as a sentence names them.

    Examples
    --------
    >>> cameras(["a"], 4), cameras(["a", "b"], 4)
    ("camera 'a'", "cameras 'a' and 'b'")
    >>> cameras(["a", "b", "c"], 3), cameras(["a", "b"], 2)
    ('all cameras', "cameras 'a' and 'b'")
    """
    if len(names) == total > 2:
        return "all cameras"
    return f"camera{'s' if len(names) > 1 else ''} {listed([repr(name) for name in names])}"


def listed(parts: Sequence[str], joint: str = "and") -> str:
    """Return parts joined as in a sentence; of very many, only the first.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b", "c"]), listed([str(n) for n in range(9)])
    ('a', 'a, b and c', '0, 1, 2, 3, 4, 5 and 3 more')
    """
    if len(parts) > LISTED:
        parts = [*parts[:LISTED], f"{len(parts) - LISTED} more"]
    return f" {joint} ".join(filter(None, (", ".join(parts[:-1]), parts[-1])))


def seconds(t_s: float) -> str:
    """Return a time as short as it may be.

    Examples
    --------
    >>> seconds(0.04), seconds(12.345), seconds(30000.0), seconds(1.7e9)
    ('0.04', '12.3', '30000', '1700000000')
    """
    return f"{t_s:.3g}" if abs(t_s) < 1000 else f"{t_s:.0f}"
