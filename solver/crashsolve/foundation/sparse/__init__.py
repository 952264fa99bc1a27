"""Sparse matrices of joints and of nodes beside joints: planned once, factored in every step."""
