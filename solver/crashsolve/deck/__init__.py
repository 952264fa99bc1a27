"""From the text of a deck to checked cards, with every error reported at its location; no model."""
