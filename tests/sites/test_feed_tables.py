"""The tables `[feeds.NAME]`: one way for messages to come, and what the site needs for it."""

from pathlib import Path

import pytest

from made_rigs import ring
from made_site import make_site
from trecsim.errors import ConfigError
from trecsim.service.viewing import site_view
from trecsim.sites import read_site
from trecsim.sites.check import check_site
from trecsim.sites.feed_brokers import Broker, broker_of
from trecsim.sites.recorded_site import RecordedSite
from trecsim.sites.ruled import RULED
from trecsim.toml_models import examined

MQTT = '[[outputs]]\nkind = "mqtt"\nurl = "mqtt://10.0.0.9"\n'
POSTED = "[feeds.gate]\nhttp = true\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[page]\n[feeds.gate]\n", "feeds.gate: expected one of file.* and .*, found none"),
        ("[page]\n[feeds.gate]\nhttp = false\n", "feeds.gate: expected one of .*, found none"),
        (
            '[page]\n[feeds.gate]\nhttp = true\nfile = "gate.jsonl"\n',
            "feeds.gate: expected one of .*, found file and http",
        ),
        (POSTED, r"line 6: feeds.gate.http: .*expected a table \[page\], found none"),
        ('[page]\nfeeds_token_env = "A B"\n', "line 6: page.feeds_token_env"),
        ('[feeds.a]\nmqtt = "a"\n', "line 6: feeds.a.mqtt: .*an MQTT output .*found neither"),
        (
            f'[feeds.a]\nmqtt = "a"\n{MQTT}name = "x"\n{MQTT}name = "y"\n',
            "feeds.a.mqtt: .*found 2 such outputs",
        ),
        ('[feeds.a]\nmqtt = "a/#/b"\n', "line 6: feeds.a.mqtt: expected a topic"),
        ('[feeds.a]\nmqtt = "a+/b"\n', "line 6: feeds.a.mqtt: expected a topic"),
        ('[feeds.a]\nmqtt = ""\n', "line 6: feeds.a.mqtt: expected a topic"),
        (
            '[feeds.a]\nmqtt = "a"\nbroker = "mqtt://kim:s3cret@10.0.0.9"\n',
            "line 7: feeds.a.broker: passwords and tokens do not belong into the URL",
        ),
        ('[feeds.a]\nmqtt = "a"\nbroker = "http://10.0.0.9"\n', "feeds.a.broker: expected a URL"),
        (
            f'[feeds.a]\nmqtt = "a"\ncredentials = "yard"\n{MQTT}',
            "feeds.a: credentials: only beside broker",
        ),
        (
            '[feeds.a]\nfile = "a.jsonl"\nbroker = "mqtt://10.0.0.9"\n',
            "feeds.a: broker: only a feed with mqtt has one, found file",
        ),
    ],
)
def test_a_feed_whose_messages_cannot_come_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        read_site(make_site(tmp_path, 2, text))


def test_a_feed_to_which_no_program_may_post_is_remarked(tmp_path: Path) -> None:
    for keys, remarked in (
        ("", False),
        ('token_env = "TOKEN"\n', True),
        ('token_env = "TOKEN"\nfeeds_token_env = "FEEDS"\n', False),
    ):
        remarks = check_site(make_site(tmp_path, 2, f"[page]\n{keys}{POSTED}")).remarks
        found = [one for one in remarks if one.startswith("feeds.gate.http: only admins")]
        assert len(found) == remarked, keys


def test_the_page_is_told_how_messages_come_and_no_path(tmp_path: Path) -> None:
    text = f'[page]\n{POSTED}most_per_s = 20\n[feeds.lift]\nfile = "lift.jsonl"\n'
    view = site_view(read_site(make_site(tmp_path, 2, text)), ring(3))
    assert view.feeds == {
        "gate": {"source": "http", "most_per_s": 20.0},
        "lift": {"source": "file", "most_per_s": 100.0},
    }


def test_the_broker_of_a_feed_is_its_own_or_that_of_the_output(tmp_path: Path) -> None:
    text = (
        '[feeds.a]\nmqtt = "gates/+/tickets"\n'
        '[feeds.b]\nmqtt = "b"\nbroker = "mqtts://10.0.0.8"\ncredentials = "yard"\nca = "ca.pem"\n'
        f'{MQTT}credentials = "hall"\n'
    )
    path = make_site(tmp_path, 2, text)
    site = read_site(path).site
    found = {name: broker_of(one, site.outputs) for name, one in site.feeds.items()}
    assert found == {
        "a": Broker("mqtt://10.0.0.9", "hall"),
        "b": Broker("mqtts://10.0.0.8", "yard", tmp_path / "ca.pem"),
    }
    assert any(
        one.startswith("feeds.b.credentials: there are no credentials 'yard'")
        for one in check_site(path).remarks
    )


def test_feeds_and_volumes_come_back_from_the_summary_of_a_recording(tmp_path: Path) -> None:
    text = (
        f'[page]\n{POSTED}[feeds.lift]\nfile = "lift.jsonl"\n'
        '[feeds.yard]\nmqtt = "yard"\nbroker = "mqtt://10.0.0.9"\n'
        '[volumes.truck]\nsize_m = [4.0, 2.0, 2.0]\nfeed = "yard"\n'
        "[volumes.cart]\nsize_m = [1.0, 1.0, 1.0]\npath_m = [[0.0, 0.0]]\n"
    )
    site = read_site(make_site(tmp_path, 2, text)).site
    kept = site.model_dump(mode="json")
    found, faults = examined(
        RecordedSite, {key: kept[key] for key in RULED if key in kept}, {"folder": tmp_path}
    )
    assert faults == []
    assert found is not None
    assert (found.feeds, found.volumes) == (site.feeds, site.volumes)
