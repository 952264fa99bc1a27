"""Shapes a surface may have."""
