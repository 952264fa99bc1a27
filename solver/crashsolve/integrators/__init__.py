"""Time integrators, one file each."""
