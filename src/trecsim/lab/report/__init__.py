"""Recordings as pages to read, show and print."""
