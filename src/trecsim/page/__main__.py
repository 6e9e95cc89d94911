"""The page process: ``python -m trecsim.page LISTENING LINK``, both numbers of inherited sockets.

`trecsim.page.page_process` starts it. It ends when the link does.
"""

import os
import signal
import socket
import sys

from trecsim.page.link import TO_PAGE, Setup, receive_body

# Where all cores are busy, the tracking gets three times the share of the page: viewers must not
# slow it down. The page still gets enough to send every snapshot, as its work is short.
NICENESS = 5


def main() -> None:
    """Serve the page until the link to the tracking process ends."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # the parent ends this process
        signal.signal(number, signal.SIG_IGN)
    os.nice(NICENESS)
    listening, link = (socket.socket(fileno=int(handle)) for handle in sys.argv[1:3])
    body = receive_body(link)
    if body is None:
        return
    setup = TO_PAGE.decode(body)
    if not isinstance(setup, Setup):
        raise TypeError(f"expected the setup first, found {type(setup).__name__}")
    from trecsim.page.serving import serve

    serve(setup, listening, link)


if __name__ == "__main__":
    main()
