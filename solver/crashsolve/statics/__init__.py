"""Statics: equilibria under loads, their balance and stability; no integration over time."""
