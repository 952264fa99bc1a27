"""Ground floor: errors, units, records, vectors, rotations, curves and the constraint solver."""

from crashsolve.foundation.compile import CALLABLE, COMPILING, set_up_numba

# before any module below can import numba; a run does not
if COMPILING or CALLABLE:
    set_up_numba()
