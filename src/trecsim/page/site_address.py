"""The address of a page as a site file gives it."""

from trecsim.page.address import PageAddress
from trecsim.sites.page_table import PageTable


def page_address(table: PageTable) -> PageAddress:
    """Return where the page of a site listens."""
    return PageAddress(
        host=table.host, port=table.port, hosts=tuple(table.hosts), users_file=table.users,
        token_env=table.token_env, tls_cert=table.tls_cert, tls_key=table.tls_key,
        trusted_proxy=table.trusted_proxy, insecure=table.insecure,
        feeds_token_env=table.feeds_token_env,
    )  # fmt: skip
