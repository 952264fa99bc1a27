"""What of a run is to be seen, and how: the words of `crashpost render --help`."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Look:
    """Of bodies and parts `show`; all where it is empty."""

    show: tuple[str, ...] = ()
    color: str = ""
    arrows: str = ""
    ghost: bool = True
    # displacements from the start are drawn this many times as large
    magnify: float = 1.0

    @property
    def note(self) -> str:
        """What a picture must say, for lengths in it are not true."""
        return "" if self.magnify == 1.0 else f"displacements x {self.magnify:g}"
