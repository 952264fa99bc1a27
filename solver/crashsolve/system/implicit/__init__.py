"""Equations of implicit steps: stages, linear systems, iteration; the methods are integrators/."""
