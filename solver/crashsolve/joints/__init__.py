"""Joints: kinematic constraints between two bodies."""
