"""Numbers of a result: channels, statistics, injury, expectations, ledgers; no drawings."""
