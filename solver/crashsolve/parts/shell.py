"""Shell: four-node elements with one point in their plane and layers through the thickness.

    eps = eps_m + z kappa,   sigma from the material in plane stress,   gamma in 5/6 G gamma
    N = int sigma dz,   M = int sigma z dz

in axes that turn with the element (`shells/elements/quadrilateral.py`). Strains of a step are those
of its middle, so that a rigid motion strains nothing. What one point cannot see is resisted by the
stiffness of bending in the plane, of bending, and of the assumed shear of the sides; its energy is
`hourglass`. A node has a quarter of the mass m of each element beside it and m / 4 (A + t^2) / 12
about any axis. Consequence to test: any patch of elements holds constant strain and constant
curvature.

References: Belytschko, Lin and Tsay (1984), Explicit algorithms for the nonlinear dynamics of
shells, Computer Methods in Applied Mechanics and Engineering 42, 225-251.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crashsolve.deck.building import Columns, Scene
from crashsolve.elements.damping import coefficients
from crashsolve.elements.shells.cards import ShellCard
from crashsolve.elements.shells.energies import kinetic_energy
from crashsolve.elements.shells.layout import DiscretisedShell
from crashsolve.elements.shells.outputs import FIELDS as FIELDS
from crashsolve.elements.shells.records import MAX_LAYERS, WORK
from crashsolve.foundation.kernels import kernel
from crashsolve.foundation.record import Record
from crashsolve.foundation.vec3 import ZERO

if TYPE_CHECKING:
    from crashsolve.parts._rows.shell import History, Output, Parameters

STEPWISE = CALLS_MATERIAL = True
# but for these, which strain elements from the start of a step to its end, and to its stages
IMPLICIT = ("generalized_alpha", "radau_iia_5")
# the column that counts elements of a kind, and the file of its kernels and of its tangent
KINDS = {"one_point": "reduced", "four_points": "full", "triangles": "triangle"}
KERNELS, SLOPES = "elements.shells.forces", "elements.shells.tangents"
ROWS = WORK.SIZE
FAMILY = "matsum"


class Shell(ShellCard):
    """Thin shell of quadrilaterals."""


PARAMETERS = Record(f"""
    first_point    index                  of the part's points
    point_count    count                  points
    first          index                  of the part's numbers in blocks
    stride         count                  numbers of a block
    first_corner   index                  of the part's corners
    aside          count                  from there to the corners that take its forces; not 0 of a
                                          piece alone
    element_count  count                  elements
    one_point      count                  of them, quadrilaterals with one point in their plane
    four_points    count                  quadrilaterals with 2 by 2 points
    triangles      count                  triangles, which come after the quadrilaterals
    first_element  index                  number of the part's first element among all
    layers         count                  points through the thickness
    zeta           1       {MAX_LAYERS}  positions of the layers, -1 to 1
    weight         1       {MAX_LAYERS}  weights of the layers, sum 2
    law            index                  of the material's law among those of the group
    young          Pa                     E
    shear          Pa                     G
    poisson        1                      nu
    density        kg/m^3                 rho
    plane          Pa                     E / (1 - nu^2)
    large_strain   flag                   whether strain across the thickness is logarithmic
    dissipates     flag                   whether layers lose some of the work on them
    yields         flag                   whether stresses beside the layers yield with them
    erodes         flag                   whether layers fail
    drag           1/s                    alpha
    damping        s                      beta
    linear         1                      b_1
    quadratic      1                      b_2^2
    is_damped      flag                   whether elements keep rows of damping and added mass
    layer_rows     count                  numbers of a layer
    thins          flag                   whether the thickness follows the strain
""")
HISTORY = Record("damped  J  energy lost by drag")
OUTPUT = Record("""
    kinetic         J      of the nodes that are no bodies
    strain          J      elastic energy of the layers and of transverse shear
    hourglass       J      of hourglass
    drilling        J      of spins of the nodes about the normal against the rotation of the plane
    plastic         J      plastic work
    drag            J      energy lost by drag
    damping         J      energy lost by damping of strains and viscosity
    eroded          J      elastic energy lost with layers that failed and elements deleted
    eroded_kinetic  J      kinetic energy of elements when deleted; it stays with the nodes
    eroded_mass     kg     of elements deleted; it stays with the nodes
    deleted         count  elements deleted
""")

# thickness over width of elements, from which a warning states that the part is no thin shell
MANY = 4.0


def build(card: Shell, scene: Scene) -> DiscretisedShell:
    """The part in place."""
    if card.layers == 1:
        scene.warn(
            f"part '{scene.under_way}': a shell of one layer is a membrane: it resists stretching, "
            "and no bending; give layers: 2 or more (5 where it yields)"
        )
    part = DiscretisedShell(card, scene)
    width = float(np.sqrt(part.area.mean()))
    if card.thickness > MANY * width:
        scene.warn(
            f"part '{scene.under_way}' is {card.thickness / width:.0f} times as thick as its "
            "elements are wide: the kinematics of shells are those of thin walls; take fewer, "
            "wider elements"
        )
    return part


def bodies(part: DiscretisedShell) -> list[Columns]:
    """The nodes that are bodies."""
    speed = part.velocities()
    return [
        {
            "mass": part.mass[i],
            "inertia": part.J[i] * np.eye(3),
            "mass_centre": ZERO,
            "position": part.mesh.points[i],
            "quaternion": (1.0, 0.0, 0.0, 0.0),
            "velocity": speed[i],
            "angular_velocity": part.spin[i],
        }
        for i in part.named
    ]


def parameters(part: DiscretisedShell, scene: Scene) -> Columns:
    """Columns of PARAMETERS but for the positions in the tables."""
    card = part.card
    zeta, weight = part.rule
    room = np.zeros(MAX_LAYERS - card.layers)
    law, material = part.law, part.law.build(part.material, scene)
    count = part.quad_count
    return {
        "thins": card.thinning,
        "layer_rows": part.layer_rows,
        "layers": card.layers,
        "one_point": count if part.points == 1 else 0,
        "four_points": count if part.points == 4 else 0,
        "triangles": len(part.area) - count,
        "zeta": np.append(zeta, room),
        "weight": np.append(weight, room),
        "drag": card.drag,
        "damping": card.damping,
        "linear": coefficients(card, scene)[0],
        "quadratic": coefficients(card, scene)[1],
        "is_damped": part.is_damped,
        **{name: material[name] for name in ("young", "shear", "poisson", "density", "plane")},
        "large_strain": law.LARGE_STRAIN,
        "dissipates": law.DISSIPATES,
        "yields": law.VON_MISES,
        "erodes": part.can_fail,
        "material": material,
    }


@kernel
def energies(p: Parameters, new: History, out: Output, scene):
    """Energies of a part but for its elements. Writes: out."""
    out.kinetic = kinetic_energy(p, scene.points)
    out.strain = out.hourglass = out.drilling = out.plastic = out.damping = 0.0
    out.eroded = out.eroded_kinetic = out.eroded_mass = 0.0
    out.deleted = 0
    out.drag = new.damped
