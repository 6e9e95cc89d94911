"""Whether the receivers of a site's outputs are there, without sending any of them an event."""

import os
import ssl
from contextlib import closing
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from urllib.parse import urlsplit

from trecsim.errors import Error
from trecsim.outputs.base import UndeliveredError
from trecsim.outputs.mqtt import broker_answer
from trecsim.outputs.opening import mail_of
from trecsim.sites.output_tables import (
    DeliveryTable,
    JsonlOutput,
    MailOutput,
    MqttOutput,
    WebhookOutput,
)
from trecsim.sites.site_file import Site
from trecsim.sources.streams.camera_login import find_key, find_login

LOOK_S = 5.0


def look_at(table: DeliveryTable, site: Site) -> str:
    """Return what was found at an output.

    Raises
    ------
    Error
        When it cannot be used; the text says why, and holds no secret.
    """
    match table:
        case JsonlOutput():
            return _file(table)
        case WebhookOutput():
            return _receiver(table, site)
        case MqttOutput():
            login = (
                None if table.credentials is None else find_login(table.credentials, site.secrets)
            )
            return broker_answer(table.url, login, table.ca, LOOK_S)
        case MailOutput():
            return mail_of(table, site, lambda event: ()).look()
    raise AssertionError(table)


def _file(table: JsonlOutput) -> str:
    folder = table.file.parent
    if table.file.is_dir() or not folder.is_dir():
        raise Error(f"expected a file in a folder that is there, found {table.file}")
    if not os.access(table.file if table.file.exists() else folder, os.W_OK):
        raise Error(f"{table.file} cannot be written")
    return f"{table.file} can be written"


def _receiver(table: WebhookOutput, site: Site) -> str:
    if table.credentials is not None:
        find_key(table.credentials, site.secrets)
    parts = urlsplit(table.url)
    host = parts.hostname or ""
    connection = HTTPConnection(host, parts.port, timeout=LOOK_S)
    if parts.scheme == "https":
        connection = HTTPSConnection(
            host, parts.port, timeout=LOOK_S, context=ssl.create_default_context()
        )
    with closing(connection):
        try:
            connection.connect()
        except (OSError, HTTPException) as error:
            said = error.strerror if isinstance(error, OSError) else None
            raise UndeliveredError(f"{host}: {said or type(error).__name__}") from None
    signed = "signed" if table.credentials else "not signed"
    return f"{host} takes connections; events are {signed}; whether it takes them was not tried"
