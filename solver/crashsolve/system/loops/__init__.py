"""Loops of a step over groups of joints, springs, elements, contacts and sensors.

Ordinary Python over the placeholders of system/placeholders.py. compose copies these functions for
a scene, once for every group they are given; they are never called as they stand here.
"""
