"""Part of a package of toy families, so that tests do not change when a law is added."""
