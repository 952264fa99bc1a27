"""Reading a deck: text, places of keys, parameters, overrides, items, cards."""
