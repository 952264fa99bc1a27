# written by `python -m crashsolve.stubs` from the records of the law
from crashsolve.foundation.rows import Numbers

class RowParameters:
    first_row: int  # [index] first constraint row

class ForceHistory:
    dissipated: float  # [J] energy lost so far
    power: float  # [W] its present rate

class ForceOutput:
    stored: float  # [J] recoverable energy
    power: float  # [W] rate of energy lost, or of work done by a load
    loss: float  # [J] energy lost in this step without a rate

class ContactParameters:
    a: int  # [index] element on side a
    b: int  # [index] element on side b
    card: int  # [index] contact card
    order: int  # [count] +1 when a is on side a of the card, -1 when on side b
    speed_floor: float  # [m/s] closing speed below which a touch counts as resting
    thick: float  # [m] half thickness of both sides where they are thinnest; infinite with a plane
    spread_a: float  # [m] how much farther the element on side a reaches than it is thick
    spread_b: float  # [m] the same for side b

class ContactHistory:
    active: int  # [flag] touching
    depth: float  # [m] penetration; negative is a gap
    impact_speed: float  # [m/s] closing speed at the onset
    dissipated: float  # [J] by the normal force
    power: float  # [W] its present rate
    friction_dissipated: float  # [J] by friction
    friction_power: float  # [W] its present rate
    push: Numbers[float]  # [N] normal force on side a
    friction_force: Numbers[float]  # [N] friction on side a
    bristled: float  # [J] recoverable energy of friction
    position: Numbers[float]  # [m] point of contact

class ContactOutput:
    force: Numbers[float]  # [N] on side a
    point: Numbers[float]  # [m] point of contact
    stored: float  # [J] recoverable energy of the normal force
    friction_stored: float  # [J] recoverable energy of the friction bristle
