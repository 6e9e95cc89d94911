"""The keys of the site file; :mod:`trecsim.sites.site_reading` reads a file by them.

Paths in a site file are relative to the file.
"""

from collections.abc import Callable
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from trecsim.calibration import FORMATS, Floor, read_rig
from trecsim.errors import InputError
from trecsim.fusion.arguments import LONGEST_LAG_S
from trecsim.geometry import Rig
from trecsim.sites.estimator_table import EstimatorTable
from trecsim.sites.feed_brokers import feed_broker_faults
from trecsim.sites.feed_tables import feed_source_faults
from trecsim.sites.fusion_table import FusionTable
from trecsim.sites.output_tables import MOST_OUTPUTS, AnyOutput, output_faults
from trecsim.sites.page_table import PageTable
from trecsim.sites.ruled import Ruled
from trecsim.sites.rules import refuse
from trecsim.sites.site_names import Name
from trecsim.sources.poses_files import FPS_RANGE
from trecsim.sources.streams.stream_address import (
    Transport,
    asks_for_login,
    check_device,
    check_url,
)
from trecsim.store.retention import Retention
from trecsim.toml_models import FilePath, SizePx, Table, Vector


class FloorTable(Table):
    """The way from the frame of a calibration file to the floor."""

    rotation_deg: Vector = (0.0, 0.0, 0.0)
    """Rotation vector: its direction is the axis, its length the angle [degrees]."""
    translation_m: Vector = (0.0, 0.0, 0.0)
    """Shift after the rotation [m]."""
    up: Literal["z", "y", "-y", "-z"] | None = None
    """Axis that points up after both; without it z, unless the cameras clearly show another."""

    def floor(self) -> Floor:
        """Return the floor as the readers of rigs take it."""
        return Floor(self.rotation_deg, self.translation_m, self.up)


class RigTable(Table):
    """Where the calibration of the cameras is, and what it does not say by itself."""

    file: FilePath
    """File or directory in any format that `trecsim rig show` reads."""
    format: str | None = Field(default=None, json_schema_extra={"enum": [f.name for f in FORMATS]})
    """Name of the format; recognised by the content if not given."""
    unit_m: float | None = Field(default=None, ge=1e-6, le=1e3)
    """Length of the file's unit [m]; if not given, that of the format, or a guess with a remark."""
    size_px: SizePx | None = None
    """Image width and height of all cameras [px], for formats that do not have it."""
    floor: FloorTable | None = None
    """The floor in the file's frame; if not given, the floor is z = 0."""

    def read(self, remark: Callable[[str], None]) -> Rig:
        """Read the rig.

        Parameters
        ----------
        remark
            Is called with what is doubtful about it without being wrong.

        Raises
        ------
        CalibrationError
            When there is no such rig or something in it is wrong.
        """
        return read_rig(
            self.file,
            format=self.format,
            unit_m=self.unit_m,
            floor=self.floor.floor() if self.floor else None,
            size_px=self.size_px,
            remark=remark,
        )


def _as_fault(check: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return a check whose errors are faults of a key."""

    def checked(given: Any) -> Any:
        try:
            return check(given)
        except InputError as error:
            raise ValueError(str(error)) from None

    return checked


_MOST_MASKS = 50
_Pixel = Annotated[float, Field(ge=-1e5, le=1e5)]
MaskPolygon = Annotated[
    list[Annotated[tuple[_Pixel, _Pixel], Field(strict=False)]], Field(min_length=3, max_length=100)
]
"""Corners of a part of an image, x and y each [px]."""


class SourceTable(Table):
    """The source of one camera: one of `video`, `url` and `device`."""

    video: FilePath | None = None
    """A recording of this camera."""
    url: Annotated[str, AfterValidator(_as_fault(check_url))] | None = None
    """A live camera on the network, without user and password: `rtsp://10.0.0.12:554/stream1`."""
    device: (
        Annotated[str, BeforeValidator(_as_fault(check_device), json_schema_input_type=str | int)]
        | None
    ) = None
    """A live camera at this machine: `/dev/video0`, or its number."""
    credentials: Name | None = None
    """User and password of the camera, by their name: see `secrets`."""
    transport: Transport = "tcp"
    """How RTSP brings the images: "tcp" loses none, "udp" waits for none."""
    mask_px: Annotated[list[MaskPolygon], Field(max_length=_MOST_MASKS)] = Field(
        default_factory=list
    )
    """Polygons in this camera's image that are blanked before anything looks: privacy masks."""

    @property
    def is_live(self) -> bool:
        """Whether it is a camera, and no recording of one."""
        return self.video is None

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        given = [key for key in ("video", "url", "device") if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise ValueError(f"expected one of video, url and device, found {found}")
        extra = {"credentials", "transport"} & self.model_fields_set
        if extra and self.url is None:
            raise ValueError(f"{' and '.join(sorted(extra))}: only a camera with a url has that")
        if self.credentials is None and self.url and asks_for_login(self.url):
            raise ValueError("a url with {user} and {password} needs credentials")
        return self


class PosesTable(Table):
    """2D poses of all cameras in files."""

    file: FilePath
    """A `*.poses.jsonl` file, or what OpenPose or COCO tools wrote: see `trecsim track`."""
    fps: float | None = Field(default=None, ge=FPS_RANGE[0], le=FPS_RANGE[1])
    """Frames per second, for files with frame numbers instead of times."""
    names: dict[str, str] = Field(default_factory=dict)
    """Name in the rig by the name in the files, for cameras that differ."""


class OutputTable(Table):
    """What is kept of a run."""

    directory: FilePath | None = None
    """Gets one folder per run; without it `recordings/NAME` beside the site file."""
    lag_s: float = Field(default=0.0, ge=0.0, le=LONGEST_LAG_S)
    """Delay of the reported states behind the newest image [s]; later images make them smoother."""
    poses: bool = False
    """Whether to keep the 2D poses too, as `poses.jsonl`."""
    paths_s: float = Field(default=60.0, gt=0.0)
    """Length of the paths in the picture of paths, up to the end of the run [s]."""


class RepairTable(Table):
    """What is done about a camera that was knocked while the site runs."""

    automatic: bool = False
    """Whether its pose is fitted to the people anew, beside being named. Each repair is logged, and
    `trecsim calibrate revoke` takes it back; the rig file never changes."""


class RetentionTable(Table):
    """How long a site with live cameras keeps what it stores; the oldest goes first."""

    tracks_h: float = Field(default=72.0, gt=0.0, le=1e6)
    """Tracks are deleted when they are older [h]."""
    events_d: float = Field(default=90.0, gt=0.0, le=1e5)
    """Events, and the tracks they point to, are deleted when they are older [days]."""
    tracks_gb: float | None = Field(default=None, gt=0.0, le=1e9)
    """The oldest tracks are deleted when all take more room [GB]; no limit if not given."""

    def limits(self) -> Retention:
        """Return the limits as the store takes them."""
        return Retention(
            3600.0 * self.tracks_h,
            86400.0 * self.events_d,
            None if self.tracks_gb is None else 1e9 * self.tracks_gb,
        )


def _file_table(given: Any) -> Any:
    return {"file": given} if isinstance(given, str) else given


RigPlace = Annotated[RigTable, BeforeValidator(_file_table, json_schema_input_type=str | RigTable)]
PosesPlace = Annotated[
    PosesTable, BeforeValidator(_file_table, json_schema_input_type=str | PosesTable)
]

NOT_YET = {
    **dict.fromkeys(
        ("reconnect_s", "reconnect"),
        "a lost camera is tried again by itself, after 0.5 s and then at longer intervals",
    ),
    **dict.fromkeys(
        ("alerts", "notify"),
        "events are sent by [[outputs]], to a file, an MQTT broker, a web service or by mail",
    ),
}


class Site(Ruled):
    """One site: cameras, sources, settings and output."""

    not_yet = NOT_YET

    format: Literal["trecsim.site/1"]
    """Always this."""
    name: Name
    """What the site is called: letters, digits, `-` and `_`."""
    rig: RigPlace
    """The calibration of the cameras: its file, or a table."""
    sources: dict[str, SourceTable] = Field(default_factory=dict)
    """The source of each camera, by the name of the camera in the rig."""
    secrets: FilePath | None = None
    """A file with `NAME = "user:password"` for each `credentials` that the environment lacks."""
    poses: PosesPlace | None = None
    """2D poses of all cameras in place of `sources`: their file, or a table."""
    estimator: EstimatorTable = EstimatorTable()
    """The 2D pose estimator."""
    fusion: FusionTable = FusionTable()
    """Settings of the association and the fit."""
    output: OutputTable = OutputTable()
    """What is kept of a run."""
    repair: RepairTable = RepairTable()
    """What is done about a camera that was knocked while the site runs."""
    retention: RetentionTable = RetentionTable()
    """How long a site with live cameras keeps what it stores."""
    page: PageTable | None = None
    """The live page; without the table there is none."""
    outputs: Annotated[list[AnyOutput], Field(max_length=MOST_OUTPUTS)] = Field(
        default_factory=list
    )
    """Where events are sent, beside the page."""

    @property
    def is_live(self) -> bool:
        """Whether any of its cameras is live."""
        return any(source.is_live for source in self.sources.values())

    @model_validator(mode="after")
    def _one_kind_of_source(self) -> Self:
        if bool(self.sources) == (self.poses is not None):
            found = "both" if self.sources else "neither"
            raise ValueError(f"expected either [sources.CAMERA] or poses, found {found}")
        return self

    @model_validator(mode="after")
    def _outputs_fit(self) -> Self:
        faults = list(output_faults(self.outputs, self.rules))
        if faults:
            refuse("Site", faults)
        return self

    @model_validator(mode="after")
    def _feeds_come(self) -> Self:
        faults = [
            *feed_source_faults(self.feeds, self.page),
            *feed_broker_faults(self.feeds, self.outputs),
        ]
        if faults:
            refuse("Site", faults)
        return self
