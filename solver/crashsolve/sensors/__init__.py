"""Sensors: what is measured, not what acts."""
