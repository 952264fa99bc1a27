"""Figures of channels, in one style; pictures of the model are in renders/."""
