"""What an element is: strains, stresses, forces, tangents and energies; sets of them are parts."""
