"""Model (never changes), State (all that changes) and the build from cards to both; no step."""
