"""One deck with many values of its parameters: plan, runs, table; settings are the same."""
