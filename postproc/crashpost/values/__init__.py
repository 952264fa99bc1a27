"""Numbers asked of a result, in words and units: channels, statistics, injury, expectations."""
