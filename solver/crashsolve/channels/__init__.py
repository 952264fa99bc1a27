"""Channels: expressions, functions, statistics and units, for solver and post-processor alike.

A leaf: it imports nothing of the mechanics, and numpy only where numbers are computed.
"""
