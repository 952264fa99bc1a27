"""Meshes: places of nodes, corners of elements, and sets of nodes with names."""
