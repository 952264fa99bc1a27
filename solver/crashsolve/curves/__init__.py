"""Curves a deck may name: from a table, a file or a formula, all as piecewise cubics."""
