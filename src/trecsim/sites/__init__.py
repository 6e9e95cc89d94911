"""The site file: its keys, how it is read, and how it is checked."""

from trecsim.sites.fusion_table import fusion_settings
from trecsim.sites.site_file import Site
from trecsim.sites.site_reading import SiteFile, read_site, site_schema

__all__ = ["Site", "SiteFile", "fusion_settings", "read_site", "site_schema"]
