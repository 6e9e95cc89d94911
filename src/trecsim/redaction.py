"""Secrets in addresses: no message may show them."""

import re

_SCHEME = r"\b([A-Za-z][A-Za-z0-9+.-]+:/{1,3})"
# A password may hold anything, even spaces and another @: only the last @ of the line ends it.
_USER = re.compile(rf"{_SCHEME}.*@")
# What was cut by dots may have been cut before its last @. In "rtsp://..." nothing was.
_CUT = re.compile(rf"{_SCHEME}.*[:@].*(?<!://)\.\.\.")
_CUT_USER = re.compile(
    rf"{_SCHEME}[^\s'\"<>/:]*:(?![0-9]{{0,5}}(?:[^\w%]|$))[^\s'\"<>/]*"  # no port follows
)
# Without a scheme: "admin:pw@cam". A colon before a space, a slash or a backslash is none of these.
_BARE_USER = re.compile(r"(?<![^\s'\"=(\[{])[^\s'\"=/:@(\[{]+:(?![\s/\\]).*@(?=[\w.-]+)")
# A value may hold spaces and quotes. It ends with "&", with the quotes or the clause around it, or
# with the line.
_VALUE = r"(?:(?!&|['\"](?:$|[\s,;:.)\]}])|[,;:)](?:$|\s)).)+"
_QUERY = re.compile(
    rf"([?&;][\w.-]*(?:pas|pwd|token|key|auth|secret|user|usr|login|sig|cred)[\w.-]*=){_VALUE}",
    re.IGNORECASE | re.MULTILINE,
)
# Some cameras take it in the path: rtsp://10.0.0.12/user=admin_password=pw_channel=1_stream=0.sdp
_PASSWORD = re.compile(
    rf"((?:password|passwd|pwd|\bpw|\bpass)=){_VALUE}", re.IGNORECASE | re.MULTILINE
)


def redacted(text: str) -> str:
    """Return a text without the user names, passwords and tokens in its addresses.

    Examples
    --------
    >>> redacted("cannot read rtsp://admin:pw@10.0.0.12:554/stream1?token=4711")
    'cannot read rtsp://***@10.0.0.12:554/stream1?token=***'
    """
    if "=" in text:  # before all else: a value may hold an @, or what looks like a scheme
        text = _PASSWORD.sub(r"\1***", _QUERY.sub(r"\1***", text))
    if "@" in text:
        text = _BARE_USER.sub("***@", text)
    if ":/" in text:
        text = _CUT.sub(r"\1***", text)
    if "@" in text:
        text = _USER.sub(r"\1***@", text)
    if ":/" in text:  # an address that was cut before its @
        text = _CUT_USER.sub(r"\1***", text)
    return text


def is_address(text: str) -> bool:
    """Tell whether a text is an address or a device rather than a file.

    Examples
    --------
    >>> [is_address(text) for text in ("rtsp://10.0.0.12/1", "/dev/video0", "C:/north.mp4")]
    [True, True, False]
    """
    return bool(_ADDRESS.match(text))


def address(path: str) -> str:
    """Return an address with both slashes, of which a path keeps only one.

    Examples
    --------
    >>> address("rtsp:/10.0.0.12/1")
    'rtsp://10.0.0.12/1'
    """
    return re.sub(r"^([A-Za-z][A-Za-z0-9+.-]+:)/(?!/)", r"\1//", path)


_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/|/dev/|\\\\\.\\")
