"""Shell elements: strains, forces, tangents; the card is parts/shell.py, materials are
elsewhere.
"""
