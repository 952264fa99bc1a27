# written by `python -m crashsolve.stubs` from the records of the law
from typing import Protocol
from crashsolve.foundation.rows import Numbers, Row

class Parameters(Row, Protocol):
    first_point: int  # [index] of the part's points
    point_count: int  # [count] points
    first: int  # [index] of the part's numbers in blocks
    stride: int  # [count] numbers of a block
    first_corner: int  # [index] of the part's corners
    aside: int  # [count] from there to the corners that take its forces; not 0 of a piece alone
    element_count: int  # [count] elements
    one_point: int  # [count] of them, quadrilaterals with one point in their plane
    four_points: int  # [count] quadrilaterals with 2 by 2 points
    triangles: int  # [count] triangles, which come after the quadrilaterals
    first_element: int  # [index] number of the part's first element among all
    layers: int  # [count] points through the thickness
    zeta: Numbers[float]  # [1] positions of the layers, -1 to 1
    weight: Numbers[float]  # [1] weights of the layers, sum 2
    law: int  # [index] of the material's law among those of the group
    young: float  # [Pa] E
    shear: float  # [Pa] G
    poisson: float  # [1] nu
    density: float  # [kg/m^3] rho
    plane: float  # [Pa] E / (1 - nu^2)
    large_strain: int  # [flag] whether strain across the thickness is logarithmic
    dissipates: int  # [flag] whether layers lose some of the work on them
    yields: int  # [flag] whether stresses beside the layers yield with them
    erodes: int  # [flag] whether layers fail
    drag: float  # [1/s] alpha
    damping: float  # [s] beta
    linear: float  # [1] b_1
    quadratic: float  # [1] b_2^2
    is_damped: int  # [flag] whether elements keep rows of damping and added mass
    layer_rows: int  # [count] numbers of a layer
    thins: int  # [flag] whether the thickness follows the strain

class History(Row, Protocol):
    damped: float  # [J] energy lost by drag

class Output(Row, Protocol):
    kinetic: float  # [J] of the nodes that are no bodies
    strain: float  # [J] elastic energy of the layers and of transverse shear
    hourglass: float  # [J] of hourglass
    drilling: float  # [J] of spins of the nodes about the normal against the rotation of the plane
    plastic: float  # [J] plastic work
    drag: float  # [J] energy lost by drag
    damping: float  # [J] energy lost by damping of strains and viscosity
    eroded: float  # [J] elastic energy lost with layers that failed and elements deleted
    eroded_kinetic: float  # [J] kinetic energy of elements when deleted; it stays with the nodes
    eroded_mass: float  # [kg] of elements deleted; it stays with the nodes
    deleted: int  # [count] elements deleted
