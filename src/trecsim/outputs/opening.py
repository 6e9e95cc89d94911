"""From the tables of a site file to the outputs that they name."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from trecsim.extras import needed
from trecsim.outputs.base import Event, Output
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.json_lines import JsonLines
from trecsim.outputs.mail import Mail
from trecsim.outputs.mqtt import Mqtt
from trecsim.outputs.rule_states import RuleStates
from trecsim.outputs.webhook import Webhook
from trecsim.safety.rule import SEVERITIES
from trecsim.sites.output_tables import (
    DeliveryTable,
    JsonlOutput,
    MailOutput,
    MqttOutput,
    WebhookOutput,
)
from trecsim.sites.rules import zone_of
from trecsim.sites.site_file import Site
from trecsim.sources.streams.camera_login import find_key, find_login
from trecsim.store.ledger import Ledger


def deliveries(
    site: Site, ledger: Ledger, open_events: Callable[[], Iterable[Event]]
) -> list[Delivery]:
    """Return what delivers the events of a ledger to the outputs of a site; nothing runs yet.

    Parameters
    ----------
    site
        What the site file says.
    ledger
        Of the site. Cursors of outputs that the site does not have any more are forgotten.
    open_events
        Returns the newest event of each episode that is open.

    Raises
    ------
    SetupError
        When a package is missing.
    """
    if any(isinstance(one, MqttOutput) for one in site.outputs):
        needed("MQTT outputs need paho-mqtt", "outputs", "paho.mqtt.client")
    ledger.forget_cursors(one.called for one in site.outputs)
    return [
        Delivery(
            one.called,
            one.kind,
            partial(output_of, one, site, ledger, open_events),
            ledger,
            partial(is_wanted, one),
        )
        for one in site.outputs
    ]


def is_wanted(table: DeliveryTable, event: Event) -> bool:
    """Tell whether an output gets an event: by its severity and its rule."""
    data = event["data"]
    if SEVERITIES.index(data["severity"]) < SEVERITIES.index(table.severity):
        return False
    return table.rules is None or data["rule"]["id"] in table.rules


def output_of(
    table: DeliveryTable,
    site: Site,
    ledger: Ledger,
    open_events: Callable[[], Iterable[Event]] = list,
) -> Output:
    """Return the output of a table.

    Raises
    ------
    ConfigError
        When its credentials cannot be found.
    SetupError
        When a package is missing.
    """
    match table:
        case JsonlOutput():
            return JsonLines(table.file)
        case WebhookOutput():
            key = None if table.credentials is None else find_key(table.credentials, site.secrets)
            return Webhook(table.url, key, timeout_s=table.timeout_s)
        case MqttOutput():
            open_now = [event for event in open_events() if is_wanted(table, event)]
            return Mqtt(
                table.url,
                site.name,
                RuleStates(table.rules or [rule.id for rule in site.rules], open_now),
                client_id=f"trecsim-{site.name}-{table.called}",
                login=_login(table.credentials, site),
                ca=table.ca,
                onvif_prefix=table.onvif_prefix,
            )
        case MailOutput():
            return mail_of(table, site, partial(_earlier, ledger))
    raise AssertionError(table)


def mail_of(table: MailOutput, site: Site, earlier: Callable[[Event], Iterable[Event]]) -> Mail:
    """Return the output of a table of mail; see `output_of`."""
    return Mail(
        table.url,
        table.sender,
        table.to,
        earlier,
        zone_of(site.timezone),
        login=_login(table.credentials, site),
        starttls=table.starttls,
        page_url=table.page_url,
    )


def _login(name: str | None, site: Site) -> Any:
    return None if name is None else find_login(name, site.secrets)


def _earlier(ledger: Ledger, event: Event) -> list[Event]:
    """Return the events of an episode that came before one of them."""
    number = ledger.number_of(event["id"])
    found = ledger.events(episode=event["data"]["event"])
    return [one.event for one in found if number is None or one.number < number]
