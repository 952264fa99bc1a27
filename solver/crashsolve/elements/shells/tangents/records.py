"""Named rows that the tangents of shells work with, sixteen elements side by side.

BASE is computed once for all columns of a tangent, CHANGE for the present column.
"""

from crashsolve.foundation.record import Record, rows_of

# numbers of strains and resultants at a point of the plane, and first number of the others
# (layers.py)
SIDE = 12
BENDING, MODES_IN, SHEAR_IN, TAKEN_OUT, ACROSS_OUT = 3, 6, 10, 10, 11
POINT_ROWS = SIDE * SIDE
FRAME = rows_of(
    Record("""
        axes       1    9  of the element
        diagonals  m    4  in them
        hourglass  m    3  h_x, h_y and z of the corners
        area       m^2     of the element
        spin       1/m  4  slopes of the spin of the axes by the diagonals
    """)
)
BASE = rows_of(
    Record(f"""
        middle            m           {FRAME.SIZE}  frame of the middle of the step
        end               m           {FRAME.SIZE}  frame of its end
        displacement      m                     12  of the step along the axes of its middle
        rotations         rad                   12  of the step, the same
        mode_actions      N, N m                21  what acts on the motions of the end
        stress            N/m, N                15  N, M, of modes, of the change of shear, V, half
                                                    of drilling
        tau               Pa                     2  transverse shear
        thickness_before  m                         of the step
        thickness_after   m                         of the step
        relaxed           1                         share of all that yielding relaxes
        relaxed_modes     Pa                     4  and of the amplitudes of the modes
        modes             m                      7  of the step: modes, change of shear, drilling
        amplitude         Pa                     4  of the trial hourglass
        points            Pa m    {5 * POINT_ROWS}  tangents of the layers of each point, and of
                                                    damping
    """)
)
CHANGE = rows_of(
    Record(f"""
        direction     1            3  rotation of the corner
        strain        1           15  in the order of BASE.stress
        moved         m            5  diagonals and area of the middle
        stressed      N/m, N      15  in the order of BASE.stress
        mode_actions  N, N m      24  forces and torques of the corners
        across        1               strain across the thickness
        sums          N/m, N       8  over the points
        relaxed       1               share of all that is relaxed
        point_strain  1       {SIDE}  strains and curvatures at a point of the plane
        point_stress  Pa m    {SIDE}  resultants of that point
    """)
)
