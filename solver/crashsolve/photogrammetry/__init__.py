"""Photogrammetry: from points in pictures to the posture of a chain of segments; no run."""
