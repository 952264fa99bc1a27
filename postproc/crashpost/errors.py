"""What crashpost says when it cannot do what was asked: one kind of error for all requests."""

from crashsolve.channels.errors import ChannelError as PostError
from crashsolve.channels.errors import unknown

__all__ = ["PostError", "unknown"]
