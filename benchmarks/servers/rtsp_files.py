"""An RTSP server of video files, played again and again; run by the system's Python.

Usage: python3 rtsp_files.py NAME=FILE.mp4 ...   (H.264, which is sent as it is)

Prints `port N` when it listens; each file is at /NAME.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402


def report_often(factory: object, media: GstRtspServer.RTSPMedia) -> None:
    """Send the clock of the camera every half second in place of every 5 s."""

    def prepared(media: GstRtspServer.RTSPMedia) -> None:
        media.get_stream(0).get_rtpsession().set_property("rtcp-min-interval", 500 * 10**6)

    media.connect("prepared", prepared)


def main() -> None:
    Gst.init(None)
    server = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service("0")
    for given in sys.argv[1:]:
        name, _, file = given.partition("=")
        factory = GstRtspServer.RTSPMediaFactory()
        factory.set_launch(
            f"( filesrc location={file} ! qtdemux ! h264parse ! "
            "rtph264pay name=pay0 pt=96 config-interval=-1 )"
        )
        factory.set_shared(True)
        factory.connect("media-configure", report_often)
        server.get_mount_points().add_factory(f"/{name}", factory)
    server.attach(None)
    print(f"port {server.get_bound_port()}", flush=True)
    GLib.MainLoop().run()


main()
