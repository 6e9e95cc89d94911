"""An RTSP camera made of GStreamer; run by the system's Python, which has its bindings.

Usage: python3 rtsp_camera.py '{"size_px": [320, 96], "fps": 20, "port": 0, "login": "me:pw"}'

Mounts /cam (video) and /sound (no video). Prints `port N` when it listens. Each image shows in its
first 16 rows, as 2 x 24 blocks of 8 px, the milliseconds of Unix time when it was made. Reads
commands from its standard input: `size W H`, `still 0|1`.
"""

import json
import sys
import threading
import time

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstApp", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstApp, GstRtspServer  # noqa: E402

BLOCK_PX, BITS = 8, 48
ENCODER = (
    "videoconvert ! x264enc tune=zerolatency threads=1 sliced-threads=false speed-preset=ultrafast "
    "bitrate={kbps} key-int-max={fps} ! rtph264pay name=pay0 pt=96 config-interval=-1"
)


class Camera:
    """Makes images while somebody watches."""

    def __init__(self, size_px: tuple[int, int], fps: int) -> None:
        self.size_px, self.fps, self.still = size_px, fps, False

    def image(self, number: int) -> bytes:
        """Return an image in I420, with the time painted into it."""
        width, height = self.size_px
        now_ms = 0 if self.still else int(time.time() * 1000)
        bits = [now_ms >> (BITS - 1 - n) & 1 for n in range(BITS)]
        rows = []
        for half in (bits[:24], bits[24:]):
            row = b"".join((b"\xeb" if bit else b"\x10") * BLOCK_PX for bit in half)
            rows.append(row.ljust(width, b"\x80") * BLOCK_PX)
        grey = 128 if self.still else 64 + number % 128
        below = bytes([grey]) * (width * (height - 2 * BLOCK_PX))
        return b"".join([*rows, below, b"\x80" * (width * height // 2)])

    def configure(self, _: object, media: GstRtspServer.RTSPMedia) -> None:
        """Feed a media that was just made."""
        source = media.get_element().get_child_by_name("source")
        over = threading.Event()
        media.connect("unprepared", lambda _: over.set())
        media.connect("prepared", report_often)
        threading.Thread(target=self.feed, args=(source, over), daemon=True).start()

    def feed(self, source: GstApp.AppSrc, over: threading.Event) -> None:
        """Push images at an even pace."""
        began_s, number, size_px = time.monotonic(), 0, None
        while not over.wait(max(0.0, began_s + number / self.fps - time.monotonic())):
            if size_px != self.size_px:
                size_px = self.size_px
                width, height = size_px
                source.set_caps(
                    Gst.Caps.from_string(
                        f"video/x-raw,format=I420,width={width},height={height},"
                        f"framerate={self.fps}/1"
                    )
                )
            buffer = Gst.Buffer.new_wrapped(self.image(number))
            if source.emit("push-buffer", buffer) != Gst.FlowReturn.OK:
                return
            number += 1


def report_often(media: GstRtspServer.RTSPMedia) -> None:
    """Send the clock of the camera every half second in place of every 5 s."""
    media.get_stream(0).get_rtpsession().set_property("rtcp-min-interval", 500 * 10**6)


def locked(server: GstRtspServer.RTSPServer, login: str) -> GstRtspServer.RTSPPermissions:
    """Let only those in who have the login; return the permissions of the mounts."""
    user, _, password = login.partition(":")
    token = GstRtspServer.RTSPToken()
    token.set_string("media.factory.role", "user")
    auth = GstRtspServer.RTSPAuth()
    auth.add_basic(GstRtspServer.RTSPAuth.make_basic(user, password), token)
    server.set_auth(auth)
    permissions = GstRtspServer.RTSPPermissions()
    permissions.add_permission_for_role("user", "media.factory.access", True)
    permissions.add_permission_for_role("user", "media.factory.construct", True)
    return permissions


def mount(server, path, launch, permissions, configure=None):
    """Add a stream to a server."""
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch(f"( {launch} )")
    factory.set_shared(True)
    if permissions is not None:
        factory.set_permissions(permissions)
    if configure is not None:
        factory.connect("media-configure", configure)
    server.get_mount_points().add_factory(path, factory)


def obey(camera: Camera) -> None:
    """Follow the commands on the standard input; end with it."""
    for line in sys.stdin:
        command, *values = line.split()
        if command == "size":
            camera.size_px = (int(values[0]), int(values[1]))
        elif command == "still":
            camera.still = values == ["1"]


def main() -> None:
    given = json.loads(sys.argv[1])
    Gst.init(None)
    camera = Camera(tuple(given["size_px"]), given["fps"])
    server = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service(str(given.get("port", 0)))
    permissions = locked(server, given["login"]) if "login" in given else None
    encoder = ENCODER.format(fps=camera.fps, kbps=given.get("kbps", 1000))
    source = "appsrc name=source is-live=true format=time do-timestamp=true block=false"
    mount(server, "/cam", f"{source} ! {encoder}", permissions, camera.configure)
    sound = "audiotestsrc is-live=true ! alawenc ! rtppcmapay name=pay0 pt=8"
    mount(server, "/sound", sound, permissions)
    if not server.attach(None):
        sys.exit("cannot listen")
    print("port", server.get_bound_port(), flush=True)
    threading.Thread(target=obey, args=(camera,), daemon=True).start()
    GLib.MainLoop().run()


if __name__ == "__main__":
    main()
