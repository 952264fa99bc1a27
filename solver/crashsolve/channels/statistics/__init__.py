"""One file for each statistic; `channels/statistic.py` says what it may hold."""
