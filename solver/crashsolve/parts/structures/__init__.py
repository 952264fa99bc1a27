"""Structures in ordinary cards: one file for each description of how members deform."""
