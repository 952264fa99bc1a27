"""Reading of a results folder: histories, states, status and log; no evaluation."""
