"""What the compiler makes of lanes.py: vectors of eight numbers, transposed by eight.

Targets with shorter vectors split them.
"""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

from crashsolve.foundation.lanes import EIGHT, NEXT, add_forces, take_motion
from crashsolve.foundation.point import LANES
from crashsolve.foundation.table_types import WORD, Column, Table, number_place

DOUBLE = ir.DoubleType()
# bytes from one motion to the next, and what a vector holds of a point: r, v, and w but for z
SIZE, HELD = 8, 8


@type_callable(take_motion)
def _type_take(context: Any) -> Any:
    def typer(points: Any, corners: Any, first: Any, work: Any, at: Any) -> Any:
        if isinstance(points, Table):
            return signature(types.none, points, corners, types.intp, work, types.intp)
        return None

    return typer


@type_callable(add_forces)
def _type_add(context: Any) -> Any:
    def typer(
        points: Any, corners: Any, first: Any, work: Any, at: Any, loads: Any, live: Any
    ) -> Any:
        if isinstance(points, Table):
            ints = (types.intp, types.intp, types.intp)
            return signature(types.none, points, corners, types.intp, work, *ints)
        return None

    return typer


class Places:
    """Addresses of the numbers of points and of rows of `work`."""

    def __init__(self, context: Any, builder: Any, sig: Any, args: Any) -> None:
        self.context, self.builder = context, builder
        self.table, self.corners, _, self.work = sig.args[:4]
        self.args = args
        proxy = cgutils.create_struct_proxy(self.table)
        self.data = proxy(context, builder, value=args[0]).data

    def number(self, e: int, name: str, k: int, size: int) -> Any:
        """Where `size` numbers of the point of the e-th element begin."""
        context, builder = self.context, self.builder
        at = builder.add(self.args[2], WORD(e))
        sig = signature(self.corners.number, self.corners, types.intp)
        place = number_place(context, builder, sig, (self.args[1], at))
        index = context.cast(builder, builder.load(place), self.corners.number, types.intp)
        record = self.table.row.record
        offset = builder.mul(index, WORD(record.size))
        offset = builder.add(offset, WORD(record.offset(name) + SIZE * k))
        return self.pointer(builder.gep(self.data, [offset], inbounds=True), size)

    def row(self, k: int, size: int = EIGHT, e: int = 0, first: int = 4) -> Any:
        """Where the numbers of eight lanes begin, k rows after that of an argument."""
        at = self.builder.add(self.args[first], WORD(LANES * k + e))
        sig = signature(types.float64, self.work, types.intp)
        place = number_place(self.context, self.builder, sig, (self.args[3], at))
        return self.pointer(place, size)

    def pointer(self, place: Any, size: int) -> Any:
        kind = ir.VectorType(DOUBLE, size) if size > 1 else DOUBLE
        return self.builder.bitcast(place, kind.as_pointer())


def transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Eight vectors of eight: what was a row becomes a column, one bit of the places at a time."""
    for bit in (1, 2, 4):
        stay = [j if not j & bit else EIGHT + j - bit for j in range(EIGHT)]
        move = [j + bit if not j & bit else EIGHT + j for j in range(EIGHT)]
        found = list(rows)
        for i in (i for i in range(EIGHT) if not i & bit):
            for place, mask in ((i, stay), (i + bit, move)):
                places = ir.Constant(ir.VectorType(ir.IntType(32), EIGHT), mask)
                found[place] = builder.shuffle_vector(rows[i], rows[i + bit], places)
        rows = found
    return rows


@lower_builtin(take_motion, Table, Column, types.intp, Column, types.intp)
def _take(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    places = Places(context, builder, sig, args)
    names = ("r", "v", "w")
    record = places.table.row.record
    assert [record.offset(name) for name in names] == [3 * SIZE * q for q in range(3)]
    points = [builder.load(places.number(e, "r", 0, HELD), align=SIZE) for e in range(EIGHT)]
    for k, row in enumerate(transposed(builder, points)):
        builder.store(row, places.row(NEXT * (k // 3) + k % 3), align=SIZE)
    for e in range(EIGHT):
        last = builder.load(places.number(e, "w", 2, 1))
        builder.store(last, places.row(2 * NEXT + 2, 1, e))
    return context.get_dummy_value()


@lower_builtin(add_forces, Table, Column, types.intp, Column, types.intp, types.intp, types.intp)
def _add(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    places = Places(context, builder, sig, args)
    record = places.table.row.record
    names = ("force", "torque", "load", "spin_load")
    begins = [record.offset(name) - record.offset("force") for name in names]
    assert begins == [0, 3 * SIZE, 6 * SIZE, 7 * SIZE]
    rows = [places.row(NEXT * (k // 3) + k % 3) for k in range(6)]
    rows += [places.row(k, first=5) for k in range(2)]
    points = transposed(builder, [builder.load(row, align=SIZE) for row in rows])
    for e, forces in enumerate(points):
        with builder.if_then(builder.icmp_signed("<", WORD(e), args[6]), likely=True):
            place = places.number(e, "force", 0, EIGHT)
            total = builder.fadd(builder.load(place, align=SIZE), forces)
            builder.store(total, place, align=SIZE)
    return context.get_dummy_value()
