"""How Python hands groups of arrays to kernels: flat, and grouped again in compiled code.

Numba looks at every array of a tuple each time Python calls a kernel with it, which takes four
times as long as the same arrays one by one; compiled code groups them for nothing. So a kernel that
takes groups has an entry that takes their arrays one after the other.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any


class Signature:
    """The parameters of a kernel, of which some are groups, as seen in one call.

    Parameters
    ----------
    name
        Of the kernel.
    arguments
        Of the call. Tuples among them are groups, and may hold others.
    """

    def __init__(self, name: str, arguments: Sequence[Any]) -> None:
        self._name = name
        self._types: dict[str, type] = {}
        flat = iter(range(_count(arguments)))
        grouped = [self._grouped(argument, flat) for argument in arguments]
        flat_names = ", ".join(f"_{n}" for n in range(_count(arguments)))
        groups = ", ".join(f"g{n}" for n in range(len(arguments)))
        spread = ", ".join(_spread(argument, f"g{n}") for n, argument in enumerate(arguments))
        self.has_groups = any(isinstance(a, tuple) for a in arguments)
        self.entry = f"def {name}({flat_names}):\n    return kernel({', '.join(grouped)})\n"
        self._caller = f"def {name}({groups}):\n    return entry({spread})\n"

    def flat(self, kernel: Any, module: str) -> Callable[..., Any]:
        """Return the plain function that groups flat arguments and calls `kernel`."""
        return _made(self._name, self.entry, {"kernel": kernel, "__name__": module, **self._types})

    def grouping(self, entry: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function that takes the groups and calls `entry` with their arrays."""
        return _made(self._name, self._caller, {"entry": entry})

    def _grouped(self, argument: Any, flat: Iterator[int]) -> str:
        """Return the expression that makes one argument of the flat ones."""
        if not isinstance(argument, tuple):
            return f"_{next(flat)}"
        inside = "".join(f"{self._grouped(part, flat)}, " for part in argument)
        if not hasattr(argument, "_fields"):
            return f"({inside})"
        self._types[type(argument).__name__] = type(argument)
        return f"{type(argument).__name__}({inside})"


def _count(arguments: Sequence[Any]) -> int:
    """Return the number of arguments when all groups are spread."""
    return sum(_count(a) if isinstance(a, tuple) else 1 for a in arguments)


def _spread(argument: Any, name: str) -> str:
    """Return the arguments of a call that spread one argument called `name`."""
    if not isinstance(argument, tuple):
        return name
    if not any(isinstance(part, tuple) for part in argument):
        return f"*{name}"
    return ", ".join(_spread(part, f"{name}[{n}]") for n, part in enumerate(argument))


def _made(name: str, source: str, names: dict[str, Any]) -> Callable[..., Any]:
    exec(compile(source, f"<entry of {name}>", "exec"), names)
    made: Callable[..., Any] = names[name]
    return made
