# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve._shared_rows import ElasticMaterial, ElasticSolid
from crashsolve.foundation.rows import Numbers

class Parameters(ElasticMaterial):
    volumetric: float  # [Pa] L

class Solid(ElasticSolid):
    metric: Numbers[float]  # [1] C - 1: xx, yy, zz, xy, yz, zx
