"""Kinds of shell elements: their strains, and the forces on their corners."""
