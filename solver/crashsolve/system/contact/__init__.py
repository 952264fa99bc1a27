"""Contact within a step: search, friction, impulses, work; the laws are in contact/."""
