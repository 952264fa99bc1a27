"""Elements of shells: what the file of their type is made of."""
