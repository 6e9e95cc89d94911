"""Outputs in a site file: what is wrong with them is told, and no secret is shown."""

from pathlib import Path

import pytest

from made_site import make_site
from trecsim.errors import ConfigError
from trecsim.sites.check import check_site


def site_with_output(folder: Path, text: str) -> Path:
    return make_site(folder, 2, f"[[outputs]]\n{text}")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('kind = "pager"\n', "pager"),
        ('kind = "mqtt"\nurl = "http://10.0.0.9"\n', "mqtt:// or mqtts://"),
        ('kind = "mqtt"\nurl = "mqtt://kim:s3cret@10.0.0.9"\n', "do not belong into the URL"),
        ('kind = "webhook"\nurl = "https://desk/x?token=s3cret"\n', "do not belong into the URL"),
        ('kind = "webhook"\nurl = "https://desk:s3cret"\n', "expected a URL like https://"),
        ('kind = "mqtt"\nurl = "mqtt://broker..lan"\n', "expected a URL like mqtt://"),
        ('kind = "webhook"\n', "url"),
        ('kind = "mail"\nurl = "smtp://m"\nsender = "kim"\nto = ["a@b.c"]\n', "sender"),
        ('kind = "mail"\nurl = "smtp://m"\nsender = "a@b.c"\nto = []\n', "to"),
        (
            'kind = "mail"\nurl = "smtp://m"\nsender = "a@b.c"\nto = ["a@b.c"]\n'
            'credentials = "post"\n',
            "without encryption",
        ),
        ('kind = "jsonl"\nfile = "e.jsonl"\nrules = ["stripe"]\n', "there is no rule 'stripe'"),
        (
            'kind = "jsonl"\nfile = "a"\n[[outputs]]\nkind = "jsonl"\nfile = "b"\n',
            'give each a name = "..."',
        ),
        ('kind = "jsonl"\nfile = "a"\nfiel = "b"\n', "did you mean 'file'"),
    ],
)
def test_wrong_outputs_are_told_and_no_secret_is_shown(
    tmp_path: Path, text: str, told: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        check_site(site_with_output(tmp_path, text))
    assert told in str(caught.value)
    assert "s3cret" not in str(caught.value)


def test_what_an_output_lacks_is_remarked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = 'kind = "webhook"\nurl = "https://desk/x"\n'
    remarks = " ".join(check_site(site_with_output(tmp_path, text)).remarks)
    assert "output webhook: without credentials its requests are not signed" in remarks
    assert "events of recordings are not sent" in remarks
    live = " ".join(check_site(site_with_output(tmp_path, text), as_live=True).remarks)
    assert "are not signed" in live
    assert "not sent" not in live
    monkeypatch.delenv("TRECSIM_CREDENTIALS_DESK", raising=False)
    site = site_with_output(tmp_path, f'{text}credentials = "desk"\n')
    assert "TRECSIM_CREDENTIALS_DESK" in " ".join(check_site(site).remarks)
    monkeypatch.setenv("TRECSIM_CREDENTIALS_DESK", "key without colon")
    assert "credentials" not in " ".join(check_site(site).remarks)
