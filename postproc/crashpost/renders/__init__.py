"""Pictures and films of a run, painted off-screen."""
