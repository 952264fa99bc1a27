"""Commands of crashpost beyond questions about one result."""
