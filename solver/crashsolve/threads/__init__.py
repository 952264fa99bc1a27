"""Threads that share a step: who takes which piece, how one waits; no mechanics."""
