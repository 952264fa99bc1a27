"""What an installed crashsolve brings along beside its code: example decks and the manual."""

from pathlib import Path
from shutil import copyfile

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
# folder in the package: where it is here, and which of its files go along
BROUGHT = {
    "decks": (ROOT / "decks", ("*.yaml", "*.csv", "*.inp", "*.obj", "*.stl", "*.md", "*.sh")),
    "manual": (ROOT / "solver", ("*.md",)),
}


class WithDocuments(build_py):
    """Copies them into the package; an editable install finds them where they are."""

    def run(self) -> None:
        super().run()
        if getattr(self, "editable_mode", False):
            return
        for name, (source, patterns) in BROUGHT.items():
            for path in (path for pattern in patterns for path in source.rglob(pattern)):
                target = Path(self.build_lib) / "crashsolve" / name / path.relative_to(source)
                target.parent.mkdir(parents=True, exist_ok=True)
                copyfile(path, target)


setup(cmdclass={"build_py": WithDocuments})
