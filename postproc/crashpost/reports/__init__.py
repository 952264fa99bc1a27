"""The report: one HTML page of all parts of a result."""
