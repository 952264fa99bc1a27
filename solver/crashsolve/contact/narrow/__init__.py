"""Gap and normal between two shapes, one file a pair."""
