"""One file for each statistic; `channels/statistic.py` states its contents."""
