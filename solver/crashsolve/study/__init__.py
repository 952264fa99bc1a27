"""One deck with many numerical settings: cost and error of each; the physics is the same."""
