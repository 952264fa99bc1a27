# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput
from crashsolve.foundation.rows import Numbers

class Parameters:
    first_corner: int  # [index] of the corners of the first block
    aside: int  # [count] from there to the corners that take its forces; not 0 of a piece alone
    quads: int  # [count] quadrilaterals
    triangles: int  # [count] triangles, in the blocks after theirs
    first_block: int  # [index] of the part's, and of its sums
    pressure: float  # [Pa] p
    curve: int  # [index] factor over time; 0 for none

class History(ForceHistory):
    pressure: float  # [Pa] pressure at the last step

class Output(ForceOutput):
    force: Numbers[float]  # [N] total
    pressure: float  # [Pa] present pressure
