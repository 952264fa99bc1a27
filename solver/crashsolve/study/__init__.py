"""A study: one deck, many settings; what each costs and how wrong it is."""
