"""Translation of calls of lanes.py: vectors of eight numbers, transposed by eight.

Targets with shorter vectors split them.
"""

from crashsolve.compiler.translation import arithmetic, memory
from crashsolve.compiler.translation.expressions import BUILTINS, Expressions
from crashsolve.compiler.translation.kinds import INT, NOTHING, Table, Untranslatable, Value
from crashsolve.foundation.lanes import EIGHT, NEXT, add_forces, gather_motion
from crashsolve.foundation.point import LANES

VECTOR = f"<{EIGHT} x double>"
# bytes of a number; a vector holds of a point r, v, and w but for z
SIZE = 8


class Slots:
    """Addresses of the numbers of points and of rows of `work`."""

    def __init__(self, of: Expressions, given: list[Value]) -> None:
        self.text, self.points, self.corners, self.work = of.text, given[0], given[1], given[3]
        if not isinstance(self.points.kind, Table):
            raise Untranslatable("lanes are those of points")
        self.offsets = {n: f[1] for n, f in (self.points.kind.dtype.fields or {}).items()}
        self.numbers = [given[2], *given[4:]]
        self.numbers = [arithmetic.convert(of.text, value, INT) for value in self.numbers]

    def number(self, e: int, name: str, k: int = 0) -> str:
        """Address of the k-th number of the point of the e-th element."""
        text = self.text
        at = text.value(f"add i64 {self.numbers[0].words[0]}, {e}")
        slot = memory.slot_of_number(text, self.corners, Value(INT, (at,)))
        assert hasattr(self.corners.kind, "dtype")
        index = memory.read_number(text, slot, self.corners.kind.dtype)
        row = memory.row_of(text, self.points, [index])
        return text.at("i8", row.words[0], str(self.offsets[name] + SIZE * k))

    def row(self, k: int, e: int = 0, first: int = 1) -> str:
        """Address of the numbers of eight lanes, k rows after that of an argument."""
        at = self.text.value(f"add i64 {self.numbers[first].words[0]}, {LANES * k + e}")
        return memory.slot_of_number(self.text, self.work, Value(INT, (at,)))

    def load(self, slot: str) -> str:
        return self.text.value(f"load {VECTOR}, ptr {slot}, align {SIZE}")

    def store(self, vector: str, slot: str) -> None:
        self.text.put(f"store {VECTOR} {vector}, ptr {slot}, align {SIZE}")

    def transposed(self, rows: list[str]) -> list[str]:
        """Eight vectors of eight: rows become columns, one bit of the positions at a time."""
        for bit in (1, 2, 4):
            stay = [j if not j & bit else EIGHT + j - bit for j in range(EIGHT)]
            move = [j + bit if not j & bit else EIGHT + j for j in range(EIGHT)]
            shuffled = list(rows)
            for i in (i for i in range(EIGHT) if not i & bit):
                for slot, mask in ((i, stay), (i + bit, move)):
                    listed = ", ".join(f"i32 {j}" for j in mask)
                    pair = f"{VECTOR} {rows[i]}, {VECTOR} {rows[i + bit]}"
                    line = f"shufflevector {pair}, <{EIGHT} x i32> <{listed}>"
                    shuffled[slot] = self.text.value(line)
            rows = shuffled
        return rows


def _take(of: Expressions, given: list[Value]) -> Value:
    slots = Slots(of, given)
    first = slots.offsets["r"]
    assert [slots.offsets[n] - first for n in ("r", "v", "w")] == [3 * SIZE * q for q in range(3)]
    points = [slots.load(slots.number(e, "r")) for e in range(EIGHT)]
    for k, row in enumerate(slots.transposed(points)):
        slots.store(row, slots.row(NEXT * (k // 3) + k % 3))
    for e in range(EIGHT):
        last = of.text.load("double", slots.number(e, "w", 2))
        of.text.store("double", last, slots.row(2 * NEXT + 2, e))
    return Value(NOTHING)


def _add(of: Expressions, given: list[Value]) -> Value:
    slots, text = Slots(of, given), of.text
    names = ("force", "torque", "load", "spin_load")
    begins = [slots.offsets[name] - slots.offsets["force"] for name in names]
    assert begins == [0, 3 * SIZE, 6 * SIZE, 7 * SIZE]
    # numbers: first, at, loads, live
    rows = [slots.row(NEXT * (k // 3) + k % 3) for k in range(6)]
    rows += [slots.row(k, first=2) for k in range(2)]
    points = slots.transposed([slots.load(row) for row in rows])
    for e, forces in enumerate(points):
        inside, after = text.new_label(), text.new_label()
        text.choose(text.value(f"icmp sgt i64 {slots.numbers[3].words[0]}, {e}"), inside, after)
        text.begin(inside)
        slot = slots.number(e, "force")
        total = text.value(f"fadd {text.flags} {VECTOR} {slots.load(slot)}, {forces}")
        slots.store(total, slot)
        text.begin(after)
    return Value(NOTHING)


BUILTINS.update({gather_motion: _take, add_forces: _add})
