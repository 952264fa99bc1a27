# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class Parameters:
    first_row: int  # [index] first row of the joint
    rows: int  # [count] number of rows
    node_b: int  # [index] body b of the joint
    axes: int  # [index] body whose axes are used
    holder: int  # [index] body that carries the point
    point: Numbers[float]  # [m] from the mass centre of the holder, its axes

class Output:
    force: Numbers[float]  # [N] on b
    moment: Numbers[float]  # [N m] on b, about the point
