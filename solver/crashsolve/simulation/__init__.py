"""One run of a deck, from the cards to the result files; no estimates, no series of runs."""
