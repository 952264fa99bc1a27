"""Friction laws of contact."""
