"""No card of the file's own name: not a type."""

LENGTH = 1.0
