"""Comparison of results with each other, with tests and with published numbers."""
