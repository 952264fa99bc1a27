"""Beam elements: strains, forces, tangents; the cards are parts/beam.py and its neighbours."""
