"""Where a live camera is: a URL or a device, and what FFmpeg needs to open it."""

import re
from dataclasses import dataclass, field
from typing import Literal
from urllib.parse import SplitResult, quote, urlsplit

from trecsim.errors import InputError
from trecsim.redaction import redacted
from trecsim.sources.streams.camera_login import Login

Transport = Literal["tcp", "udp"]
RTSP = ("rtsp", "rtsps")
SCHEMES = (*RTSP, "http", "https", "tcp", "udp")
MAX_IMAGE_PX = 2**26
_LONGEST = 1000  # letters; FFmpeg cuts longer paths
_UDP_BYTES = 1 << 20  # holds a key frame; the system may allow less
_LOW_DELAY = {"fflags": "nobuffer", "flags": "low_delay", "max_delay": "0"}
# Nothing that a camera sends may make FFmpeg open files or other addresses.
_RTSP = {
    "probesize": "32",
    "analyzeduration": "0",
    "allowed_media_types": "video",
    "format_whitelist": "rtsp,rtp,mpegts",
    "protocol_whitelist": "rtsp,rtsps,rtp,srtp,udp,tcp,tls,crypto",
}
_OTHER = {
    "probesize": "200000",
    "analyzeduration": "500000",
    "format_whitelist": "mpegts,mpjpeg,mjpeg,h264,hevc,flv,matroska,mov,nut",
    "protocol_whitelist": "http,https,tcp,tls,udp,httpproxy,crypto",
}
_PASSWORD = re.compile(r"(?:pas(?:s(?:word|wd)?)?|pwd|pw)=(?!\{password\})[^&/?]", re.IGNORECASE)
_NUMBER = re.compile(r"[0-9]{1,3}")
_DEVICE = re.compile(r"/dev/[A-Za-z0-9/_.:-]{1,200}")
USER, PASSWORD = "{user}", "{password}"
"""What stands in a URL for user and password, for cameras that want them there."""


@dataclass(frozen=True, slots=True)
class Opening:
    """What FFmpeg needs to open a stream; `name` may hold a password.

    Attributes
    ----------
    name
        File name or URL.
    format
        Name of the format; None lets FFmpeg find it.
    options
        By FFmpeg's names.
    """

    name: str = field(repr=False)
    format: str | None
    options: dict[str, str]


@dataclass(frozen=True, slots=True)
class NetworkAddress:
    """A camera on the network.

    Attributes
    ----------
    url
        Without user and password.
    transport
        How RTSP brings the images.
    login
        User and password; None for a camera that asks for none.
    credentials
        What the site file calls them, for messages.
    """

    url: str
    transport: Transport = "tcp"
    login: Login | None = None
    credentials: str | None = None

    def __str__(self) -> str:
        return redacted(self.url)

    def opening(self, size_px: tuple[int, int]) -> Opening:
        """Return what FFmpeg needs.

        Parameters
        ----------
        size_px
            The size that the images should have [px]; a stream has its own.
        """
        scheme = urlsplit(self.url).scheme
        if scheme in RTSP:
            options = {**_LOW_DELAY, **_RTSP, "rtsp_transport": self.transport}
            if self.transport == "udp":
                options["buffer_size"] = str(_UDP_BYTES)
        else:
            options = {**_LOW_DELAY, **_OTHER}
        return Opening(self._with_login(), None, options)

    def _with_login(self) -> str:
        if self.login is None:
            return self.url
        user, password = (quote(one, safe="") for one in (self.login.user, self.login.password))
        if asks_for_login(self.url):
            return self.url.replace(USER, user).replace(PASSWORD, password)
        return self.url.replace("://", f"://{user}:{password}@", 1)


@dataclass(frozen=True, slots=True)
class DeviceAddress:
    """A camera at this machine.

    Attributes
    ----------
    device
        As in ``/dev/video0``.
    """

    device: str

    def __str__(self) -> str:
        return self.device

    def opening(self, size_px: tuple[int, int]) -> Opening:
        """Return what FFmpeg needs.

        Parameters
        ----------
        size_px
            The size that the images should have [px].
        """
        options = {"video_size": f"{size_px[0]}x{size_px[1]}", **_LOW_DELAY}
        return Opening(self.device, "video4linux2", options)


Address = NetworkAddress | DeviceAddress


def asks_for_login(url: str) -> bool:
    """Tell whether a URL has places for user or password.

    Examples
    --------
    >>> asks_for_login("rtsp://10.0.0.12/user={user}&password={password}&channel=1")
    True
    """
    return USER in url or PASSWORD in url


def check_url(url: str) -> str:
    """Return a URL that can be that of a camera.

    Parameters
    ----------
    url
        As somebody wrote it.

    Raises
    ------
    InputError
        When it cannot be one, or user and password stand in it; the text never shows them.
    """
    parts = _split(url)
    if parts.scheme.lower() not in SCHEMES:
        known = ", ".join(f"{one}://" for one in SCHEMES)
        raise InputError(f"expected a URL that begins with one of {known}, found {_shown(url)}")
    if "@" in parts.netloc or _PASSWORD.search(url):
        raise InputError(
            "user and password do not belong into the URL. Leave them out of it, write "
            'credentials = "NAME" below it, and set the environment variable '
            "TRECSIM_CREDENTIALS_NAME to user:password, or name a file with a line "
            'NAME = "user:password" as `secrets`. For a camera that wants them inside the URL '
            "write {user} and {password} in their places"
        )
    if not parts.hostname:
        raise InputError(f"expected a URL with the address of the camera, found {_shown(url)}")
    return url


def _split(url: str) -> SplitResult:
    if len(url) > _LONGEST or not url.isprintable() or " " in url:
        raise InputError(f"expected a URL of at most {_LONGEST} letters without spaces")
    try:
        parts = urlsplit(url)
        _ = parts.port
    except ValueError:
        raise InputError(
            f"expected a URL like rtsp://10.0.0.12:554/stream1, found {_shown(url)}"
        ) from None
    return parts


def _shown(url: str) -> str:
    return repr(redacted(url)[:60])


def check_device(device: object) -> str:
    """Return the path of a device.

    Parameters
    ----------
    device
        Its path or, for ``/dev/videoN``, its number.

    Raises
    ------
    InputError
        When it cannot be one.
    """
    path = f"/dev/video{device}" if _NUMBER.fullmatch(str(device)) else str(device)
    if not _DEVICE.fullmatch(path) or ".." in path:
        raise InputError(f'expected a device like "/dev/video0" or a number, found {device!r:.60}')
    return path
