"""Deck words of earlier versions, and their present names, for messages only.

A deck with an old word is refused; the message names the new one.
"""

RENAMED = {
    "ahead": "preview_error",
    "blows": "impulses",
    "coefficient": "friction_coefficient",
    "cuts": "section_cuts",
    "friction": "friction_coefficient",
    "hold": "supports",
    "most": "limit",
    "now": "coordinate",
    "slid": "accumulated_slip",
    "slide_driver": "translation_driver",
    "slide_friction": "translation_friction",
    "slide_limit": "translation_stop",
    "steer": "steering_angle",
    "turn_driver": "rotation_driver",
    "turn_friction": "rotation_friction",
    "turn_limit": "rotation_stop",
    "turn_x": "rotation_x",
    "turn_y": "rotation_y",
    "turn_z": "rotation_z",
    "turning_damping": "rotational_damping",
    "turning_stiffness": "rotational_stiffness",
    "wanted": "target",
}
