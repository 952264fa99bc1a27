"""What all scenes share: kinetics, constraints, contact, energy, and the composed step."""
