"""Cross sections of beams: areas, second moments, torsion and shear."""
