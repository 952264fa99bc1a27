"""Photogrammetry: from points in the pictures of cameras to the posture of a chain of segments."""
