# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ForceHistory, ForceOutput, SpringPoints
from crashsolve.foundation.rows import Numbers

class Parameters(SpringPoints):
    rotation_a: Numbers[float]  # [1] unit quaternion, axes of the beam to those of a
    rotation_b: Numbers[float]  # [1] the same for b
    length: float  # [m] l
    stiffness: Numbers[float]  # [N/m] diagonal of K
    rotational_stiffness: Numbers[float]  # [N m/rad] diagonal of K_r
    damping: float  # [s] beta
    moduli: Numbers[float]  # [any] A, Z_y, Z_z
    volume: float  # [m^3] A l
    yields: int  # [flag] whether the material yields
    yield_stress: float  # [Pa] Y_0
    isotropic: float  # [Pa] H
    curve: int  # [index] Y over e; 0 for none
    rate_D: float  # [1/s] D of Cowper and Symonds; 0 for none
    rate_q: float  # [1] q of Cowper and Symonds
    buckling: float  # [N] compression to warn of; infinite if there is none
    at_rest: int  # [flag] NO_STEP, FLOWS or FROZEN, in load steps

class History(ForceHistory):
    plastic: Numbers[float]  # [any] u_p along the beam, theta_p about y and z
    resultant: Numbers[float]  # [any] N, M_y, M_z
    strain: float  # [1] e
    work: float  # [J] plastic work
    peak_compression: float  # [N] largest compression along the beam so far

class Output(ForceOutput):
    force: Numbers[float]  # [N] tension, shear along y and z, axes of the beam
    moment: Numbers[float]  # [N m] torsion, bending about y and z, in the middle
    displacement: Numbers[float]  # [m] u
    angle: Numbers[float]  # [rad] theta
    plastic_angle: Numbers[float]  # [rad] theta_p about y and z
    plastic_strain: float  # [1] e, mean over the section
    plastic_work: float  # [J] so far
