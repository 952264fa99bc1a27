"""Springs: forces between two bodies that follow from their relative motion."""
