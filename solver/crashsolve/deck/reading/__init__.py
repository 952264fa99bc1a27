"""Reading a deck: text, positions of keys, parameters, overrides, items, cards."""
