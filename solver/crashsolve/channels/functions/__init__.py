"""One file for each function of channels; `channels/expression.py` says what it holds."""
