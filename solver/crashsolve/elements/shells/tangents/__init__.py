"""Tangents of the kinds of shell elements, for implicit and quasi-static steps."""
