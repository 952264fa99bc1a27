"""Normal force laws of contact."""
