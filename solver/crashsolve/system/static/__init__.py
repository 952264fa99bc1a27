"""Quasi-static solution: equilibrium, its loads, its balance and its stability."""
