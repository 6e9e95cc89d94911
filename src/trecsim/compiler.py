"""One decorator for all compiled kernels, and the cache that keeps what the compiler made.

Numba's own cache compares only the file in which a kernel stands. A kernel contains the code of the
kernels that it calls and the constants that it imports, so an edit of a neighbouring file would
leave old code running. Here the compiled code lies in a folder named after a digest of all sources
that it can depend on: an edit of any of them selects another folder, and nothing has to be deleted
for the result to be right.
"""

import gc
import hashlib
import inspect
import os
import pickle
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

import numba
from numba.core import config
from numba.core.codegen import JITCodeLibrary, ll
from numba.core.compiler import CompileResult, Flags, compile_extra
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]  # not public
from numba.core.registry import CPUDispatcher
from numba.core.serialize import dumps
from platformdirs import user_cache_path

from trecsim.kernel_entries import Signature

# Folders of compiled code of other versions of the sources that are kept, for switching branches.
_OTHERS_KEPT = 3
_PREFIX = "kernels-"


def kernel(function: Callable[..., Any] | None = None, *, allocates: bool = False) -> Any:
    """Compile a function that Python calls, when it is first called, and keep the result.

    Other kernels may call it too, as an `inner` one.

    Parameters
    ----------
    function
        A function of numbers, arrays and groups of arrays (NamedTuples). It may call other kernels,
        and use constants of its own folder, of a module `tuning` beside that and of
        `trecsim.geometry`; a test checks that kernels import nothing else of this package.
    allocates
        Whether it makes arrays of its own. The others need no code that counts references to
        arrays, which takes a tenth of the compile time.
    """
    return (
        partial(_kernel, Kernel, allocates)
        if function is None
        else _kernel(Kernel, allocates, function)
    )


def inner(function: Callable[..., Any] | None = None, *, allocates: bool = False) -> Any:
    """Compile a function that only other kernels call, as part of them.

    It has no wrapper for Python, and its code is optimised and kept as part of the kernels that
    call it. That saves a third of the compile time and a tenth of the run time.

    Parameters
    ----------
    function, allocates
        As for `kernel`; `allocates` also if it is given new arrays by a function that makes them.
    """
    return (
        partial(_kernel, InnerKernel, allocates)
        if function is None
        else _kernel(InnerKernel, allocates, function)
    )


def _kernel(kind: type, allocates: bool, function: Callable[..., Any]) -> Any:
    plain = inspect.unwrap(function)  # of the tests' check of shapes, which wraps all functions
    compiled = _compiled(plain, no_cpython_wrapper=True, _nrt=allocates)
    if not config.DISABLE_JIT:
        compiled.__class__ = kind
        compiled._compiler.__class__ = _Translator
        compiled.allocates = allocates or kind is InnerKernel
    return compiled


def _entry(kernel: Any, arguments: Sequence[Any]) -> Any:
    """Return what Python calls to run `kernel` with arguments such as these."""
    plain = kernel.py_func
    signature = Signature(plain.__name__, arguments)
    flat = signature.flat(kernel, plain.__module__) if signature.has_groups else plain
    entry = _compiled(flat, _nrt=kernel.allocates)
    # What `enable_caching` does with numba's own.
    entry._cache = KernelCache(plain, signature.entry)
    kernel.entry = entry
    return signature.grouping(entry) if signature.has_groups else entry


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    """Let numba compile a function, without the global lock, with divisions as IEEE 754 says.

    The wrapper for C is left out, as nobody calls it and it costs compile time.
    """
    compile_with: Any = numba.njit(
        nogil=True, error_model="numpy", no_cfunc_wrapper=True, **options
    )
    return compile_with(function)


class InnerKernel(CPUDispatcher):  # type: ignore[misc]  # numba gives it no type
    """A kernel without a wrapper for Python; a call from Python, as in tests, compiles one.

    Numba would optimise it and make machine code of it by itself. Here it is only translated, then
    optimised as a part of the kernels that call it.

    Attributes
    ----------
    entry
        What is compiled for calls from Python; absent before the first.
    """

    def __call__(self, *arguments: Any) -> Any:
        """Call the version for Python."""
        if "for_python" not in self.__dict__:
            self.for_python = _entry(self, arguments)
        return self.for_python(*arguments)

    def add_overload(self, cres: CompileResult) -> None:
        """Let other kernels find a compiled version by its result, as it has no entry point."""
        cres = cres._replace(entry_point=object())
        self.targetctx.insert_user_function(cres.entry_point, cres.fndesc, [cres.library])
        self.overloads[tuple(cres.signature.args)] = cres


class Kernel(InnerKernel):
    """A kernel that the product calls from Python."""


class _Translator(_FunctionCompiler):  # type: ignore[misc]  # numba gives it no type
    """What an `InnerKernel` is compiled with: numba's front end."""

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        target = self.targetdescr.target_context
        flags = Flags()
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        flags.no_compile = True
        return compile_extra(
            self.targetdescr.typing_context, target, self.py_func, args, return_type, flags,
            self.locals, _Part(target.codegen(), self.py_func.__qualname__), self.pipeline_class,
        )  # fmt: skip


class _Part(JITCodeLibrary):  # type: ignore[misc]  # numba gives it no type
    """The code of an `InnerKernel`, to be linked into others but not run by itself.

    Numba would copy the code of all that it calls into it, and so at every level of calls. Here
    each part stays by itself until a kernel needs it.
    """

    _shared_module: Any

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Leave linking and optimisation to the kernels it becomes a part of."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Return the code of this part and of all that it calls, which may be there twice."""
        if self._shared_module is None:
            whole = self._final_module.clone()
            for library in self._below({}):
                part = isinstance(library, _Part)
                module = library._final_module if part else library._get_module_for_linking()
                whole.link_in(module, preserve=True)
            defined = [f.name for f in whole.functions if not f.is_declaration]
            for name in defined:
                function = whole.get_function(name)
                if function.linkage == ll.Linkage.external:
                    function.linkage = "linkonce_odr"
            self._shared_module = whole
        return self._shared_module

    def _below(self, found: dict[Any, None]) -> dict[Any, None]:
        """Add all libraries that this one calls to `found`, each once."""
        for library in self._linking_libraries:
            if library not in found:
                found[library] = None
                if isinstance(library, _Part):
                    library._below(found)
        return found


class KernelCache:
    """The compiled versions of one kernel, each in a file of its own; in place of numba's cache.

    A file is complete or absent, and its name says all that its content depends on: processes that
    start at once, with the same sources or with others, never read what is not theirs.

    Parameters
    ----------
    function
        The kernel's Python function.
    entry
        Source of the function that Python calls.
    """

    def __init__(self, function: Callable[..., Any], entry: str) -> None:
        source = Path(inspect.getfile(function))
        self._sources = source.parent
        self._digest = digest_of(source.parent)
        self._folder = cache_folder(source.parent)
        self._name = f"{source.stem}.{function.__qualname__}"
        self._code = function.__code__.co_code, entry
        self._enabled = True

    @property
    def cache_path(self) -> str | None:
        """Folder of the compiled code; None where none can be written."""
        return None if self._folder is None else str(self._folder)

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """Return the compiled version for a signature; None if there is none."""
        if not self._enabled or self._folder is None:
            return None
        try:
            content = pickle.loads(self._path(sig, target_context.codegen()).read_bytes())
        except (OSError, EOFError, pickle.UnpicklingError):
            return None
        target_context.refresh()
        found = CompileResult._rebuild(target_context, *content)
        _tell_ready()
        return found

    def save_overload(self, sig: Any, cres: CompileResult) -> None:
        """Keep a compiled version; a disk that is full or read-only only costs the next start."""
        _tell_ready()
        for environment in cres._find_referenced_environments():  # of the inner kernels in it
            cres.library.codegen.set_env(environment.env_name, environment)
        if not self._enabled or self._folder is None or cres.library.has_dynamic_globals:
            return
        # Sources that were edited while they were imported belong to neither digest.
        if _digest(self._sources) != self._digest:
            return
        with suppress(OSError):
            _write(self._path(sig, cres.library.codegen), dumps(cres._reduce()))

    def enable(self) -> None:
        """Use the cache."""
        self._enabled = True

    def disable(self) -> None:
        """Neither load nor save."""
        self._enabled = False

    def flush(self) -> None:
        """Forget all compiled versions of this kernel."""
        if self._folder is not None:
            for path in self._folder.glob(f"{self._name}-*.nbc"):
                path.unlink(missing_ok=True)

    def _path(self, sig: Any, codegen: Any) -> Path:
        assert self._folder is not None
        key = repr((sig, codegen.magic_tuple(), numba.__version__, self._code))
        return self._folder / f"{self._name}-{hashlib.sha256(key.encode()).hexdigest()[:20]}.nbc"


_listeners: list[Callable[[], None]] = []
# Objects after which Python looks for cycles of garbage: the compiler makes millions of objects and
# hardly any cycles, and looking for them as often as usual takes a tenth of its time.
_OBJECTS_BETWEEN_COLLECTIONS = 200_000


@contextmanager
def compiling(tell: Callable[[], None]) -> Iterator[None]:
    """Compile many kernels faster while the block runs.

    Parameters
    ----------
    tell
        Called after each kernel that is compiled or loaded from the cache meanwhile.
    """
    usual = gc.get_threshold()
    gc.set_threshold(max(usual[0], _OBJECTS_BETWEEN_COLLECTIONS), *usual[1:])
    _listeners.append(tell)
    try:
        yield
    finally:
        _listeners.remove(tell)
        gc.set_threshold(*usual)


def _tell_ready() -> None:
    for tell in _listeners:
        tell()


@cache
def digest_of(folder: Path) -> str:
    """Return the digest of all sources on which the kernels of `folder` can depend.

    It is taken once per process, when the first of its kernels is imported.
    """
    return _digest(folder)


def sources_of(folder: Path) -> Iterator[Path]:
    """Yield these sources: the folder's own, its table of constants, the geometry, and this one."""
    yield from sorted(folder.glob("*.py"))
    yield from folder.parent.glob("tuning.py")
    yield from sorted((Path(__file__).parent / "geometry").glob("*.py"))
    yield Path(__file__)


def _digest(folder: Path) -> str:
    digest = hashlib.sha256()
    for path in sources_of(folder):
        digest.update(f"{path.name}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder(sources: Path) -> Path | None:
    """Return where the compiled kernels of one folder of sources lie; None if nowhere.

    That is in NUMBA_CACHE_DIR if it is set, else beside the sources, else in the user's cache: the
    first that has some already or can be written to. Compiled code of older sources is removed.
    """
    name = f"{_PREFIX}{digest_of(sources)}-{sys.implementation.cache_tag}"
    for parent in _parents(sources):
        folder = parent / name
        if next(folder.glob("*.nbc"), None) is None and not _can_be_made(folder):
            continue
        _remove_old(folder)
        return folder
    return None


def _parents(sources: Path) -> Iterator[Path]:
    below = f"{sources.name}_{hashlib.sha256(str(sources).encode()).hexdigest()[:16]}"
    if config.CACHE_DIR:
        yield Path(config.CACHE_DIR) / below
    yield sources / "__pycache__"
    yield user_cache_path("trecsim") / "kernels" / below


def _can_be_made(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def _remove_old(folder: Path) -> None:
    """Remove all but the newest few folders of other sources, which no new process reads."""
    others = [path for path in folder.parent.glob(f"{_PREFIX}*") if path != folder]
    with suppress(OSError):  # another process may be doing the same
        others.sort(key=lambda path: path.stat().st_mtime, reverse=True)
    for path in others[_OTHERS_KEPT:]:
        shutil.rmtree(path, ignore_errors=True)


def _write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all; whoever is last wins, with the same content."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
