"""Commands of crashpost for figures, pictures and files; those that print numbers are in cli.py."""
