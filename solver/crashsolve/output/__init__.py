"""Result files: histories, states, restart dumps, status, log and peaks; no choice of what is
written.
"""
