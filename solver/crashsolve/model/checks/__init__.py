"""What is refused, or warned of, in a model before it runs."""
