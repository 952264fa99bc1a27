"""Deck layer: from a text file to checked cards, with every mistake reported at its place."""
