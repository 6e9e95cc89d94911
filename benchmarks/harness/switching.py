"""Run the fusion with a function or a constant of it replaced, as if the source had been changed.

The fusion has no switches for its parts, and shall have none. What a benchmark wants different is
replaced from outside, in every module that uses it, and put back afterwards. Compiled kernels keep
the constants and functions they were compiled with; those that depend on what is replaced are
therefore compiled anew (and the cache on disk is left alone), once per process.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from importlib import import_module
from itertools import count
from types import CodeType, FunctionType, ModuleType
from typing import Any
from unittest.mock import patch

PACKAGE = "trecsim.fusion"
_compiled: dict[str, dict[int, Any]] = {}
_numbers = count()


class NoSuchPart(Exception):  # noqa: N818  it says what it is
    """What is to be replaced is not there (any more)."""


@contextmanager
def replaced(name: str, changes: Mapping[str, Any]) -> Iterator[None]:
    """Replace parts of the fusion while the context lasts.

    Parameters
    ----------
    name
        Of the changes as a whole: what is compiled for them is kept under it for the next time.
    changes
        The new values by path below `trecsim.fusion`: ``birth.SURE_BIRTH_SCORE``,
        ``tracker.Tracker._owners``, ``kernels.lengths.tighten``. In place of a kernel stands a
        plain function, which is compiled. Where a path leads to the module that a function is
        from, it is replaced wherever it is used; else only in the module of the path.

    Raises
    ------
    NoSuchPart
        There is nothing at one of the paths.
    """
    modules = _modules()
    with ExitStack() as stack:
        touched: set[tuple[str, str]] = set()
        for path, value in changes.items():
            home, attribute, old = _found(path)
            new = _like(old, value)
            places = [(home, attribute)] if isinstance(home, type) else _uses(modules, old, path)
            for place, name_there in places:
                stack.enter_context(patch.object(place, name_there, new))
                if isinstance(place, ModuleType):
                    touched.add((place.__name__, name_there))
        for place, name_there, kernel in _dependent(modules, touched):
            fresh = _compiled.setdefault(name, {}).setdefault(id(kernel), _fresh(kernel))
            stack.enter_context(patch.object(place, name_there, fresh))
        yield


def _modules() -> list[ModuleType]:
    import_module(f"{PACKAGE}.tracker")
    return [
        module
        for name, module in sorted(sys.modules.items())
        if name == PACKAGE or name.startswith(f"{PACKAGE}.")
    ]


def _found(path: str) -> tuple[Any, str, Any]:
    """Return where something is, its name there, and the thing itself."""
    above, _, attribute = path.rpartition(".")
    home: Any = import_module(PACKAGE)
    for part in above.split("."):
        # A module before a function of the same name that hides it.
        home = sys.modules.get(f"{home.__name__}.{part}") or getattr(home, part, None)
    if not hasattr(home, attribute):
        raise NoSuchPart(f"{PACKAGE} has no {path}; was it renamed? See benchmarks/parts.py")
    return home, attribute, getattr(home, attribute)


def _like(old: Any, value: Any) -> Any:
    return _uncached(value) if _is_kernel(old) and not _is_kernel(value) else value


def _uses(modules: list[ModuleType], old: Any, path: str) -> list[tuple[Any, str]]:
    """Return where the same thing is used under its name: here, or wherever it was imported to."""
    above, _, attribute = path.rpartition(".")
    here = f"{PACKAGE}.{above}"
    home = getattr(getattr(old, "py_func", old), "__module__", here)
    if home != here:
        return [(sys.modules[here], attribute)]
    return [(module, attribute) for module in modules if vars(module).get(attribute) is old]


def _dependent(
    modules: list[ModuleType], touched: set[tuple[str, str]]
) -> list[tuple[ModuleType, str, Any]]:
    """Return every place of a kernel that must be compiled anew, as it calls what was touched."""
    places = [
        (module, name, thing)
        for module in modules
        for name, thing in vars(module).items()
        if _is_kernel(thing) and (module.__name__, name) not in touched
    ]
    stale: set[int] = set()
    while True:
        more = {
            id(kernel)
            for _, _, kernel in places
            if id(kernel) not in stale
            and any((kernel.py_func.__module__, name) in touched for name in _names(kernel.py_func))
        }
        if not more:
            return [place for place in places if id(place[2]) in stale]
        stale |= more
        touched |= {(module.__name__, name) for module, name, k in places if id(k) in more}


def _names(function: Callable[..., Any]) -> set[str]:
    """Return all names that a function, or one within it, looks up."""
    found: set[str] = set()
    todo = [function.__code__]
    while todo:
        code = todo.pop()
        found.update(code.co_names)
        todo.extend(inner for inner in code.co_consts if isinstance(inner, CodeType))
    return found


def _is_kernel(thing: object) -> bool:
    from numba.core.dispatcher import Dispatcher

    return isinstance(thing, Dispatcher)


def _fresh(kernel: Any) -> Any:
    """Return a kernel that is not compiled yet, with the same arithmetic, for any caller."""
    return _uncached(kernel.py_func, bool(kernel.targetoptions.get("_nrt", True)))


def _uncached(function: Callable[..., Any], allocates: bool = True) -> Any:
    """Return a function as a kernel of the product's kind that neither reads nor fills its cache.

    The cache tells versions of a kernel apart by the sources, which do not show what is replaced.
    Each has a name of its own: compiled code is linked by names that are unique in one process
    only, and what came from the cache was compiled in another one.
    """
    from trecsim.compiler import kernel

    name = f"{function.__name__}_{next(_numbers)}"
    own = FunctionType(
        function.__code__, function.__globals__, name, function.__defaults__, function.__closure__
    )
    own.__module__, own.__qualname__ = function.__module__, name
    made = kernel(own, allocates=allocates)
    made.__class__ = _uncached_kind()
    return made


@cache
def _uncached_kind() -> type:
    """Return the kind of these kernels; numba is imported only now."""
    from numba.core.caching import NullCache

    from trecsim import compiler

    class UncachedKernel(compiler.Kernel):
        """A kernel whose entry for Python is compiled anew in every process."""

        def __call__(self, *arguments: Any) -> Any:
            """Call the version for Python."""
            if "for_python" in self.__dict__:
                return self.for_python(*arguments)
            with patch.object(compiler, "KernelCache", lambda *_: NullCache()):
                return super().__call__(*arguments)

    return UncachedKernel
