"""What implicit integrators need of a model beside its tables."""
