"""Figures of channels, in one style."""
