"""Loads: forces that come from outside."""
