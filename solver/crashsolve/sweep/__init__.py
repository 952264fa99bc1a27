"""A deck over many values of its parameters: plan, runs, table."""
