"""Pictures and films of the model, painted off-screen; curves are in figures/."""
