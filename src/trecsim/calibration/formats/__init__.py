"""Readers and writers of calibration files, one module per tool."""
