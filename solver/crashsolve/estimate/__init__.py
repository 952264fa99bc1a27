"""Errors of the watched numbers of one run, from cheaper runs in memory; no runs that are kept."""
