"""How wrong the watched numbers of a run are, by comparison with cheaper runs of the same model."""
