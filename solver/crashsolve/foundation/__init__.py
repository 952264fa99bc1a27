"""Ground floor: errors, units, records, vectors, rotations, curves and the constraint solver."""
