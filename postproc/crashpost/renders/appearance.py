"""What of a run is drawn, and how: the options of `crashpost render`."""

from dataclasses import dataclass

from crashpost.renders.section_lines import Section


@dataclass(frozen=True)
class Appearance:
    """Appearance of a picture: bodies and parts `show`, all where it is empty."""

    show: tuple[str, ...] = ()
    color: str = ""
    arrows: str = ""
    ghost: bool = True
    # displacements from the start are drawn this many times as large
    magnify: float = 1.0
    # where of space is drawn, y<0; everywhere when empty
    cut: str = ""
    # sections of shells: part, name, point and normal
    sections: tuple[Section, ...] = ()

    @property
    def note(self) -> str:
        """Note on a picture: magnified displacements, parts left out."""
        magnified = "" if self.magnify == 1.0 else f"displacements x {self.magnify:g}"
        only = f"only {self.cut}" + " m" * self.cut[-1:].isdigit() if self.cut else ""
        return ", ".join(filter(None, [magnified, only]))
