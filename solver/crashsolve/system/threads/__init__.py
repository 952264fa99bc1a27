"""Work shared by two threads."""
