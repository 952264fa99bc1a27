"""Bodies: what carries mass."""
