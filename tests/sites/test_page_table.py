"""The table `[page]`: what it takes, and what it says about a wrong one."""

from pathlib import Path

import pytest

from trecsim.errors import ConfigError
from trecsim.page.address import PageAddress
from trecsim.page.site_address import page_address
from trecsim.sites import read_site

SITE = (
    'format = "trecsim.site/1"\nname = "yard"\nrig = "rig.toml"\nposes = "a.poses.jsonl"\n[page]\n'
)


def read(folder: Path, keys: str) -> PageAddress:
    (folder / "site.toml").write_text(SITE + keys)
    table = read_site(folder / "site.toml").site.page
    assert table is not None
    return page_address(table)


def test_an_empty_table_is_a_page_on_loopback(tmp_path: Path) -> None:
    assert read(tmp_path, "") == PageAddress()


def test_every_key_reaches_the_page(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        'host = "0.0.0.0"\nport = 0\nhosts = ["site.example"]\nusers = "users.toml"\n'
        'token_env = "SITE_TOKEN"\ntls_cert = "cert.pem"\ntls_key = "key.pem"\n'
        'trusted_proxy = "10.0.0.1"\ninsecure = true\nfeeds_token_env = "FEEDS_TOKEN"\n',
    )
    assert found == PageAddress(
        "0.0.0.0", 0, ("site.example",), tmp_path / "users.toml", "SITE_TOKEN",
        tmp_path / "cert.pem", tmp_path / "key.pem", "10.0.0.1", True, "FEEDS_TOKEN",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("port = 70000", "line 6: page.port: .*65535"),
        ('port = "80"', "line 6: page.port"),
        ('host = ""', "line 6: page.host"),
        ('hosts = ["https://site.example"]', "line 6: page.hosts"),
        ('trusted_proxy = "proxy.example"', "line 6: page.trusted_proxy: expected an IP address"),
        ('tls_cert = "cert.pem"', "line 5: page: expected tls_key beside tls_cert, found none"),
        ('tls_key = "key.pem"', "line 5: page: expected tls_cert beside tls_key, found none"),
        ('token_env = "A B"', "line 6: page.token_env"),
        ("user = 1", "line 6: page.user: .*users"),
    ],
)
def test_a_wrong_key_is_told_with_its_line(tmp_path: Path, keys: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        read(tmp_path, keys)
