"""Channels and samples of a run, and its engine between samples; files are in output/."""
