"""Materials: how a solid answers to strain, and how heavy it is."""
