"""Roles of sensors in measures of injury, and the filter classes that they are defined with.

Channel frequency classes of SAE J211-1; those of the neck and the femur are from memory.
"""

CLASSES = {
    "head": 1000,
    "chest": 180,
    "pelvis": 1000,
    "vehicle": 60,
    "neck": 600,
    "femur_left": 600,
    "femur_right": 600,
    "chest_deflection": 180,
}
