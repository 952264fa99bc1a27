# written by `python -m crashsolve.stubs` from the records of the law
from typing import Protocol
from crashsolve.foundation.rows import Numbers, Row

class Parameters(Row, Protocol):
    node_a: int  # [index] first node
    node_b: int  # [index] second node
    length: float  # [m] l
    stiffness: Numbers[float]  # [N/m] diagonal of K
    rotational_stiffness: Numbers[float]  # [N m/rad] diagonal of K_r
    bowing: Numbers[float]  # [1] c_y and c_z
    damping: float  # [s] beta
    drag_a: float  # [1/s] alpha, times the element's share in its first node
    drag_b: float  # [1/s] the same of the second
    viscosity: float  # [N s/m] rho A c b_1, of the stretch
    quadratic_viscosity: float  # [N s^2/m^2] rho A b_2^2, of its square in compression
    rate_a: float  # [1/s^2] largest k times mobility at the first node
    rate_b: float  # [1/s^2] the same at the second
    tension_rate_a: float  # [1/(kg m)] increase of that by a tension of 1 N, at the first node
    tension_rate_b: float  # [1/(kg m)] the same at the second
    bow_coupling: float  # [1/m^0.5] root of the rate of a bow of 1 m over the rate, both nodes
    buckling: float  # [N] compression to warn of; infinite if there is none
    count: int  # [count] fibres
    y: Numbers[float]  # [m] positions along y of the section
    z: Numbers[float]  # [m] positions along z of the section
    area: Numbers[float]  # [m^2] areas
    elastic: Numbers[float]  # [N, N m, N m^2] moduli of N, M_y, M_z without yield, upper half
    reach: Numbers[float]  # [m] largest distances along z and y
    law: int  # [index] of the material's law among those of the group

class History(Row, Protocol):
    peak_compression: float  # [N] largest compression along the beam so far
    strain: Numbers[float]  # [1, 1/m] eps_0, kappa_y, kappa_z
    reference_strain: Numbers[float]  # [1, 1/m] the same when the fibres were last evaluated, one by one
    reference_load: Numbers[float]  # [N, N m] N, M_y, M_z then
    reference_energy: float  # [J/m] elastic energy then
    slack: float  # [1] change of strain since then up to which no fibre yields
    plastic_strain: float  # [1] largest e of the fibres
    version: int  # [count] evaluations
    work: float  # [J] plastic work

class Output(Row, Protocol):
    force: Numbers[float]  # [N] tension, shear along y and z, axes of the element
    moment_a: Numbers[float]  # [N m] torsion, bending about y and z, at the first node
    moment_b: Numbers[float]  # [N m] torsion, bending about y and z, at the second node
    strain: Numbers[float]  # [1] stretch of the bent line, shear along y and z, u / l
    curvature: Numbers[float]  # [1/m] twist, bending about y and z, theta / l
    plastic_strain: float  # [1] largest e of the fibres
    plastic_work: float  # [J] of the element
