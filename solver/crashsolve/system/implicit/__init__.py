"""Implicit integrators: stages, their linear equations and their iteration."""
