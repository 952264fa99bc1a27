"""What a run records, and when: channels, samples, and the engine between samples."""
