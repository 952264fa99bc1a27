"""One deck with many values of its parameters: plan, runs, table; no numerical setting changes."""
