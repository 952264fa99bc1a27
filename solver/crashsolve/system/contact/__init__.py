"""Contact within a step: projections, pairs, surface friction, unilateral impulses, work."""
