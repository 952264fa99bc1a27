"""Tables of implicit integrators, made once: rows, blocks and their pattern; their solution is in
system/implicit.
"""
