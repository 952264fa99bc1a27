"""Elements: strains, forces, tangents and energies of one; neither cards of parts nor materials."""
