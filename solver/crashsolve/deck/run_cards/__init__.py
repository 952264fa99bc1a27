"""Cards that a deck has once: control, output, units, expectations."""
