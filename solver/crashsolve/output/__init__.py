"""Result files: histories, states, restart dumps, status, log and peaks."""
