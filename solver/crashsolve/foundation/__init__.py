"""Foundation: errors, records, vectors, rotations, curves, sparse solvers; no laws and no model."""
