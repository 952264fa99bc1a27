"""A point of a material by itself, compiled: row i + 1 of `points` after the strains of row i."""

from crashsolve.foundation.kernels import entry, kernel
from crashsolve.foundation.record import Record
from crashsolve.materials import elastic, elastoplastic, johnson_cook, neo_hookean

STEP = Record("""
    d       1      6  xx, yy, zz, twice xy, yz, zx
    lost    J/m^3     in the step
    stored  J/m^3     after it
""")


@kernel
def drive(h, scene, material):
    """Writes: scene.points, steps."""
    m = scene.parts[0].material
    for i in range(scene.steps.shape[0]):
        row, new = scene.steps[i], scene.points[i + 1]
        d = (row.d[0], row.d[1], row.d[2], row.d[3], row.d[4], row.d[5])
        _, lost = material.solid(m, scene.points[i], new, d, h, scene.curves, material)
        row.lost, row.stored = lost, material.solid_energy(m, new)


@entry
def drive_elastic(number, flag, scene):
    drive(number, scene, elastic)


@entry
def drive_elastoplastic(number, flag, scene):
    drive(number, scene, elastoplastic)


@entry
def drive_johnson_cook(number, flag, scene):
    drive(number, scene, johnson_cook)


@entry
def drive_neo_hookean(number, flag, scene):
    drive(number, scene, neo_hookean)
