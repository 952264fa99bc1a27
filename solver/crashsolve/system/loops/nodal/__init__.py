"""Nodes of shells in contact with surfaces and shapes, copied into the step as other loops are."""
