"""Batch solver for the impact of rigid and flexible multibody systems."""

__version__ = "0.1.0"
