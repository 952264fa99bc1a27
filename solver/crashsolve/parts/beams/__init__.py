"""Elements of beams: what the files of their types are made of."""
