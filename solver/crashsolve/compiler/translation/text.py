"""The text of one function in LLVM's language, written from top to bottom."""

from collections.abc import Iterable

# contraction and reassociation only: NaN and infinity must keep their meaning for the guards
FLAGS = "contract nsz arcp reassoc"


class Text:
    """Lines of a function; what its variables lie in comes first."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.slots: list[str] = []
        self.label = "entry"
        # whether control never gets here
        self.ended = False
        self._names = 0

    def name(self) -> str:
        """A new name for a value."""
        self._names += 1
        return f"%v{self._names}"

    def new_label(self) -> str:
        """A new name for a position to go to."""
        self._names += 1
        return f"b{self._names}"

    def put(self, line: str) -> None:
        """A line without a value."""
        self.lines.append(line)

    def value(self, line: str) -> str:
        """A line with a value; returns its name."""
        name = self.name()
        self.lines.append(f"{name} = {line}")
        return name

    def slot(self, word: str, zero: bool = False) -> str:
        """Room for a variable."""
        name = self.name()
        self.slots.append(f"{name} = alloca {word}")
        if zero:
            self.slots.append(f"store {word} zeroinitializer, ptr {name}")
        return name

    def load(self, word: str, slot: str) -> str:
        return self.value(f"load {word}, ptr {slot}")

    def store(self, word: str, value: str, slot: str) -> None:
        self.put(f"store {word} {value}, ptr {slot}")

    def at(self, word: str, slot: str, count: str) -> str:
        """Address of the count-th value from a position."""
        return self.value(f"getelementptr inbounds {word}, ptr {slot}, i64 {count}")

    def go(self, label: str) -> None:
        """End this block: go on at a label."""
        self._end(f"br label %{label}")

    def choose(self, condition: str, one: str, other: str) -> None:
        """End this block: go on at one label or another."""
        self._end(f"br i1 {condition}, label %{one}, label %{other}")

    def ret(self, words: tuple[str, ...], values: tuple[str, ...]) -> None:
        """End this block: return."""
        if not words:
            return self._end("ret void")
        whole = values[0]
        if len(words) > 1:
            kind, whole = struct_of(words), "poison"
            for k, (word, value) in enumerate(zip(words, values, strict=True)):
                whole = self.value(f"insertvalue {kind} {whole}, {word} {value}, {k}")
        self._end(f"ret {struct_of(words)} {whole}")

    def _end(self, line: str) -> None:
        if not self.ended:
            self.put(line)
        self.ended = True

    def begin(self, label: str) -> None:
        """Go on here, from above too."""
        self.go(label)
        self.put(f"{label}:")
        self.label, self.ended = label, False

    def join(self, word: str, edges: Iterable[tuple[str, str]]) -> str:
        """The value that comes from the block control comes from: (value, label) each."""
        listed = ", ".join(f"[ {value}, %{label} ]" for value, label in edges)
        return self.value(f"phi {word} {listed}")


def struct_of(words: tuple[str, ...]) -> str:
    """LLVM's type of what a function returns."""
    if not words:
        return "void"
    return words[0] if len(words) == 1 else "{ " + ", ".join(words) + " }"
