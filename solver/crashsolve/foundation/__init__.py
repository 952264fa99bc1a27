"""Ground floor: errors, units, records, vectors, rotations, curves and the constraint solver."""

from crashsolve.foundation.compile import set_up_numba

# before any module below can import numba
set_up_numba()
