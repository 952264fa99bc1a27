"""Options that the command lines of solver and post-processor share."""

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

from crashsolve.channels.errors import ChannelError

SHELLS = ("bash", "zsh", "tcsh")
# -rcforc.left.force.x, -norm(...), -'a.b.c', -(...), -2*...; but -o begins an option
_EXPRESSION = re.compile(r"-\s*(?!o)(?:[A-Za-z_]\w*\s*[.(]|['\"(\d.]|time\b)")


def protected(arguments: Sequence[str]) -> list[str]:
    """The words of a command line, expressions that begin with - kept from passing for options."""
    return [f" {word}" if _EXPRESSION.match(word) else word for word in arguments]


def output_path(text: str) -> Path:
    """Value of the option -o: an empty one, as of a variable that is not set, names nothing."""
    if not text.strip():
        raise argparse.ArgumentTypeError("is empty; name a file or folder, or leave the option out")
    return Path(text)


def add_completion(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command `completion`, whose options name the SHELL."""
    words = "print a script that completes this command, for the shell to read"
    command = commands.add_parser("completion", help=words, description=words)
    command.add_argument("shell", choices=SHELLS)


def completion(parser: argparse.ArgumentParser, shell: str) -> str:
    """The script for a shell; raises ChannelError where shtab is missing."""
    try:
        import shtab
    except ImportError:
        text = "completion needs shtab, which is missing: pip install 'crashsolve[completion]'"
        raise ChannelError(text) from None
    script: str = shtab.complete(parser, shell)
    return script
