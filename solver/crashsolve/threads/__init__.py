"""Threads that share a step: distribution of pieces, and waiting; no mechanics."""
