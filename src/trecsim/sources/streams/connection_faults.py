"""What a camera's faults mean, for the person on site; no text shows user or password."""

import socket
from urllib.parse import urlsplit

import av

from trecsim.sources.streams.camera_login import variable
from trecsim.sources.streams.stream_address import Address, DeviceAddress, NetworkAddress


def is_refusal(error: Exception) -> bool:
    """Tell whether the camera refuses user or password."""
    return isinstance(error, av.HTTPUnauthorizedError | av.HTTPForbiddenError)


def explained(error: Exception, address: Address, *, waited: bool) -> str:
    """Return what is wrong, and what to do.

    Parameters
    ----------
    error
        Of PyAV; its own text may hold the password.
    address
        Of the camera.
    waited
        Whether it came when the time for an answer was over.
    """
    if isinstance(address, DeviceAddress):
        return _of_device(error, address)
    if is_refusal(error):
        return _refused(address)
    if waited:
        return f"{address} does not answer in time; is the camera overloaded, or its network?"
    for kind, text in _TEXTS:
        if isinstance(error, kind):
            return text.format(address=address, place=_place(address))
    if not _is_known(address):
        return f"there is no host {urlsplit(address.url).hostname!r}; is the name in the URL right?"
    reason = error.strerror if isinstance(error, OSError) else type(error).__name__
    return f"cannot read {address}: {reason}"


NO_VIDEO = (
    "what {address} sends is no video that can be read here; set the camera to H.264 over RTSP"
)
_TEXTS: tuple[tuple[type[Exception], str], ...] = (
    (
        ConnectionRefusedError,
        "nothing answers at {place}; is the camera on, and the port right?",
    ),
    (
        av.HTTPNotFoundError,
        "the camera at {place} knows no such stream: {address}; look up its address in the "
        "camera's settings",
    ),
    (
        av.HTTPServerError,
        "the camera at {place} reports an error of its own for {address}; look into its log, or "
        "start it again",
    ),
    (
        av.error.HTTPOtherClientError,
        "the camera at {place} does not play {address}: there may be no video in it, or it needs "
        'the other transport, "tcp" or "udp"',
    ),
    (av.InvalidDataError, NO_VIDEO),
    (av.ArgumentError, NO_VIDEO),
    (EOFError, NO_VIDEO),
    (ConnectionResetError, "the camera at {place} ended the connection"),
    (BrokenPipeError, "the camera at {place} ended the connection"),
)


def _place(address: NetworkAddress) -> str:
    parts = urlsplit(address.url)
    return f"{parts.hostname}:{parts.port}" if parts.port else str(parts.hostname)


def _is_known(address: NetworkAddress) -> bool:
    try:
        return bool(socket.getaddrinfo(urlsplit(address.url).hostname, None))
    except (OSError, UnicodeError):
        return False


def _refused(address: NetworkAddress) -> str:
    if address.login is None:
        return (
            f"the camera at {_place(address)} asks for user and password: write "
            f'credentials = "NAME" below its URL, and set the environment variable '
            f"{variable('NAME')}"
        )
    named = address.credentials or "NAME"
    return (
        f"the camera at {_place(address)} refuses user or password; check the credentials "
        f"{named!r} ({variable(named)})"
    )


def _of_device(error: Exception, address: DeviceAddress) -> str:
    if isinstance(error, FileNotFoundError):
        return f"there is no camera {address}; is it plugged in? `ls /dev/video*` lists them"
    if isinstance(error, PermissionError):
        return f"no permission to read {address}; add this user to the group `video`"
    reason = error.strerror if isinstance(error, OSError) else type(error).__name__
    return f"cannot read {address}: {reason}"
