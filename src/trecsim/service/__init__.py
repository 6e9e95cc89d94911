"""The service: a live site, watched while it runs, with its page.

The pipeline is the same as for recordings. What is added are sinks and watchers: a monitor that
counts, the page, and the service manager of the system.
"""
