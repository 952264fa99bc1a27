"""One file for each function of channels; `channels/expression.py` states its contents."""
