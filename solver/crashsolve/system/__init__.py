"""The step: kinetics, constraints, contact, energy, composition; neither laws nor methods."""
