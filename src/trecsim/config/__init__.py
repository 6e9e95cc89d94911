"""The site file: its keys, how it is read, and how it is checked."""

from trecsim.config.reading import SiteFile, read_site, site_schema
from trecsim.config.site import Site, fusion_settings

__all__ = ["Site", "SiteFile", "fusion_settings", "read_site", "site_schema"]
