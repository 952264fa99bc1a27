"""Parts: deformable bodies made of nodes and elements."""
