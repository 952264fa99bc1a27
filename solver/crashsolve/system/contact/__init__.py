"""Contact within a step: search, areas, impulses, work; neither laws nor tables of pairs."""
