"""One deck with many numerical settings: cost and error of each; no parameter of it changes."""
