"""Results beside each other, beside tests and beside published numbers."""
