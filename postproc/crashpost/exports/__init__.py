"""Files for other programs: CSV, Parquet, ISO-MME, VTKHDF; no figures."""
