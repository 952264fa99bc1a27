"""Loops over groups: what a step does with every joint, spring, element, contact and sensor.

Ordinary Python over the placeholders of system/placeholders.py. compose copies these functions for
a scene, once for every group they are given; they are never called as they stand here.
"""
