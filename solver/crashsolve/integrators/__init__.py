"""Time integrators, one file each; forces and equations of a step are in system/."""
