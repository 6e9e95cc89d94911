"""Outputs of a site: events to files, brokers, receivers and people who are not at the page."""
