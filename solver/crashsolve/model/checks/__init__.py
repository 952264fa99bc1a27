"""Checks of a model before it runs: errors and warnings; those of single cards are in deck/."""
