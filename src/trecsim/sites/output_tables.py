"""The tables `[[outputs]]` of a site file: where events are sent, beside the page."""

import ipaddress
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self
from urllib.parse import urlsplit

from pydantic import Field, model_validator

from trecsim.errors import InputError
from trecsim.safety.rule import Severity
from trecsim.sites.receiver_urls import url_of
from trecsim.sites.site_names import Name
from trecsim.sources.streams.camera_login import find_key, find_login
from trecsim.toml_models import FilePath, Table
from trecsim.toml_models.toml_reading import Fault

MOST_OUTPUTS = 50
_ADDRESS = r"^[^@\s<>,;:\"]{1,64}@[A-Za-z0-9.-]{1,255}$"

MailAddress = Annotated[str, Field(pattern=_ADDRESS)]


class DeliveryTable(Table):
    """An output: what it gets, and where it is."""

    kind: str
    """What it is: jsonl, mqtt, webhook or mail."""
    name: Name | None = None
    """What it is called; needed where there are several of a kind. Under this name it is remembered
    which events it has got."""
    severity: Severity = "info"
    """From which severity on events are sent."""
    rules: Annotated[list[Name], Field(min_length=1)] | None = None
    """Of which rules events are sent; of all, and of faults of the site, if not given."""

    @property
    def called(self) -> str:
        """The name of the output."""
        return self.name or self.kind


class JsonlOutput(DeliveryTable):
    """Events as JSON Lines in a file."""

    kind: Literal["jsonl"]
    """Always "jsonl"."""
    file: FilePath
    """The file to which events are added, one a line."""


class MqttOutput(DeliveryTable):
    """Events, and the state of each rule, to an MQTT broker."""

    kind: Literal["mqtt"]
    """Always "mqtt"."""
    url: Annotated[str, url_of("mqtt", "mqtts")]
    """The broker: `mqtt://10.0.0.9:1883`, or `mqtts://` with encryption."""
    credentials: Name | None = None
    """User and password, by their name: see `secrets`."""
    ca: FilePath | None = None
    """Certificates by which the broker is known; those of the system if not given."""
    onvif_prefix: Annotated[str, Field(pattern=r"^[^#+\s]{1,200}$")] | None = None
    """Where events are published with the topics of ONVIF, too; nowhere if not given."""


class WebhookOutput(DeliveryTable):
    """Each event as a signed HTTP request."""

    kind: Literal["webhook"]
    """Always "webhook"."""
    url: Annotated[str, url_of("https", "http")]
    """Where events are posted."""
    credentials: Name | None = None
    """The key that signs each event, by its name: see `secrets`. All of the value is the key."""
    timeout_s: Annotated[float, Field(gt=0.0, le=300.0)] = 10.0
    """So long is waited for an answer [s]."""


class MailOutput(DeliveryTable):
    """A message when something happens, and when it gets worse."""

    kind: Literal["mail"]
    """Always "mail"."""
    url: Annotated[str, url_of("smtp", "smtps")]
    """The mail server: `smtp://10.0.0.9:25`, or `smtps://` with encryption from the start."""
    starttls: bool = False
    """Whether the connection to an `smtp://` server is encrypted once it is there."""
    credentials: Name | None = None
    """User and password, by their name: see `secrets`."""
    sender: MailAddress
    """The address from which messages come."""
    to: Annotated[list[MailAddress], Field(min_length=1, max_length=100)]
    """The addresses to which they go."""
    severity: Severity = "warning"
    """From which severity on messages are sent."""
    page_url: Annotated[str, url_of("https", "http")] | None = None
    """Where the page is, for a link in the messages."""

    @model_validator(mode="after")
    def _password_is_encrypted(self) -> Self:
        parts = urlsplit(self.url)
        if parts.scheme == "smtps" and self.starttls:
            raise ValueError(
                "starttls: smtps:// is encrypted from the start; leave one of them out"
            )
        plain = parts.scheme == "smtp" and not self.starttls
        if self.credentials is not None and plain and not _is_here(parts.hostname or ""):
            raise ValueError(
                "the password would be sent without encryption: use smtps://, or starttls = true"
            )
        return self


def _is_here(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


AnyOutput = Annotated[
    JsonlOutput | MqttOutput | WebhookOutput | MailOutput, Field(discriminator="kind")
]
"""An output of any kind; the key `kind` says which."""


def output_faults(outputs: Sequence[DeliveryTable], rules: Sequence[Any]) -> Iterator[Fault]:
    """Yield what is wrong with outputs together, and with the rules that they name."""
    counted = Counter(one.called for one in outputs)
    known = {rule.id for rule in rules}
    for number, one in enumerate(outputs):
        if counted[one.called] > 1:
            yield (
                ("outputs", number, "name" if one.name else "kind"),
                f"expected a name of its own, found {counted[one.called]} outputs called "
                f'{one.called!r}; give each a name = "..."',
            )
        for rule in one.rules or ():
            if rule not in known:
                yield ("outputs", number, "rules"), f"there is no rule {rule!r}"


def output_remarks(
    outputs: Sequence[DeliveryTable], secrets: Path | None, is_live: bool
) -> Iterator[str]:
    """Yield what outputs lack to work here and now, and what is probably a slip.

    Parameters
    ----------
    outputs
        Of the site.
    secrets
        The file of secrets, if there is one.
    is_live
        Whether the site has live cameras.
    """
    if outputs and not is_live:
        yield (
            "outputs: events of recordings are not sent; they are with live cameras, and with "
            "trecsim run --as-live"
        )
    for one in outputs:
        name: str | None = getattr(one, "credentials", None)
        if name is not None:
            try:
                (find_key if isinstance(one, WebhookOutput) else find_login)(name, secrets)
            except InputError as error:
                yield f"output {one.called}: {error}"
        elif isinstance(one, WebhookOutput):
            yield (
                f"output {one.called}: without credentials its requests are not signed, so the "
                "receiver cannot tell them from those of others"
            )
