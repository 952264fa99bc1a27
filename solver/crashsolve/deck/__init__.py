"""Deck layer: from a text file to checked cards, with every error reported at its location."""
