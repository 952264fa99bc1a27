"""A results folder opened for reading: histories, states, status and log."""
