"""The table `[page]` of a site file: where the live page listens, and what protects it."""

import ipaddress
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from trecsim.toml_models import FilePath, Table


def _number_of_host(text: str) -> str:
    try:
        return str(ipaddress.ip_address(text))
    except ValueError:
        raise ValueError(f'expected an IP address, as "10.0.0.2", found {text!r}') from None


HostNumber = Annotated[str, AfterValidator(_number_of_host)]
"""An IP address."""
HostName = Annotated[str, Field(pattern=r"^[A-Za-z0-9]([A-Za-z0-9.-]{0,251}[A-Za-z0-9])?$")]
"""A name as in the address of a page, without port."""


class PageTable(Table):
    """Where the live page listens, and what protects it."""

    host: Annotated[str, Field(min_length=1, max_length=255)] = "127.0.0.1"
    """Address or name of the network interface; any but loopback needs `users` or `token_env`."""
    port: int = Field(default=8765, ge=0, le=65535)
    """TCP port; 0 takes a free one."""
    hosts: list[HostName] = Field(default_factory=list, max_length=100)
    """Further names under which browsers reach the page, as that of a reverse proxy."""
    users: FilePath | None = None
    """The file of the users who may sign in, made by `trecsim users add`."""
    token_env: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")] | None = None
    """Name of the environment variable that holds the token of programs."""
    feeds_token_env: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")] | None = None
    """Name of the environment variable that holds the token of systems that post messages of feeds,
    and may do nothing else."""
    tls_cert: FilePath | None = None
    """Certificate of the page with its chain, PEM; makes it `https`."""
    tls_key: FilePath | None = None
    """Key of the certificate, PEM."""
    pictures: bool = False
    """Whether the page shows pictures of the cameras, two a second at most; none is stored."""
    trusted_proxy: HostNumber | None = None
    """IP address of the reverse proxy whose `X-Forwarded-For` and `X-Forwarded-Proto` count."""
    insecure: bool = False
    """Whether passwords and tokens may come over plain HTTP from other machines."""

    @model_validator(mode="after")
    def _certificate_with_key(self) -> Self:
        if (self.tls_cert is None) != (self.tls_key is None):
            given, missing = ("tls_cert", "tls_key")[:: 1 if self.tls_cert else -1]
            raise ValueError(f"expected {missing} beside {given}, found none")
        return self
