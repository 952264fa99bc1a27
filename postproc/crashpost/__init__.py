"""Post-processor of crashsolve: it reads the result files and nothing else."""
