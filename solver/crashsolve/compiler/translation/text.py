"""The text of one function in LLVM's language, written from top to bottom."""

from collections.abc import Callable, Iterable

# contraction and reciprocals only: NaN and infinity must keep their meaning for the guards.
# Sums of several lanes are done side by side, in any order; elsewhere the order is that of the
# source, so that compensated sums are kept.
FLAGS = "contract nsz arcp"
FLAGS_OF_LANES = f"{FLAGS} reassoc"

# of the checked mode: the memory read for an index out of bounds, and the function that reports it
SCRATCH, REPORT = "@scratch", "@report"


class Text:
    """Lines of a function; the slots of its variables come first."""

    def __init__(self, site: Callable[[], str] | None = None, flags: str = FLAGS) -> None:
        """`site` keeps the position in the source that is being translated, where bounds are
        checked, and returns the name of the constant.
        """
        self.site, self.flags = site, flags
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
        """A new name of a target of jumps."""
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
        """Address of the value number `count` from an address."""
        return self.value(f"{self._step} {word}, ptr {slot}, i64 {count}")

    def checked(self, slot: str, index: str, count: str) -> str:
        """The slot of an item; in checked mode another one where the index is out of bounds."""
        if self.site is None:
            return slot
        inside = self.test(self.value(f"icmp ult i64 {index}, {count}"), index, count)
        return self.value(f"select i1 {inside}, ptr {slot}, ptr {SCRATCH}")

    def test(self, holds: str, number: str, limit: str) -> str:
        """In checked mode, report that a condition does not hold; returns the condition."""
        if self.site is not None:
            failed, after = self.new_label(), self.new_label()
            self.choose(holds, after, failed)
            self.begin(failed)
            self.put(f"call void {REPORT}(ptr {self.site()}, i64 {number}, i64 {limit})")
            self.begin(after)
        return holds

    def go(self, label: str) -> None:
        """End this block: jump to a label."""
        self._end(f"br label %{label}")

    def choose(self, condition: str, one: str, other: str) -> None:
        """End this block: jump to one label or another."""
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

    @property
    def _step(self) -> str:
        """An address out of bounds may be formed where it is then replaced."""
        return "getelementptr" if self.site else "getelementptr inbounds"

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
    """LLVM type of the value that a function returns."""
    if not words:
        return "void"
    return words[0] if len(words) == 1 else "{ " + ", ".join(words) + " }"
