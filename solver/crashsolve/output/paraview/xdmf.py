"""The text of states.xdmf: XDMF 2 as the reader of ParaView 5.11 takes it."""

from collections.abc import Callable, Iterable

from crashsolve.output.blocks import CELL_TYPES, POINTS, Block, FieldSpec

ATTRIBUTE_TYPES = {1: "Scalar", 3: "Vector", 6: "Tensor6", 9: "Tensor"}


def index(collections: Iterable[tuple[str, list[str]]]) -> str:
    """Whole file: for each block its name and its grids in time order."""
    lines = ['<?xml version="1.0"?>', '<Xdmf Version="2.0">', "<Domain>"]
    for name, grids in collections:
        lines.append(f'<Grid Name="{name}" GridType="Collection" CollectionType="Temporal">')
        lines += grids
        lines.append("</Grid>")
    return "\n".join([*lines, "</Domain>", "</Xdmf>", ""])


def geometry(block: Block, mesh_file: str) -> str:
    """Elements of the index that are the same at every time: topology, points unless each state has
    its own, fields.
    """
    dataset = f"{mesh_file}:/{block.name}"
    kind = "Mixed"
    if len(block.cells) == 1:
        cell = CELL_TYPES[block.cells[0][0]]
        kind = cell.xdmf
        if cell.open_ended:
            kind += f'" NodesPerElement="{cell.corners}'
    lines = [
        f'<Topology TopologyType="{kind}" NumberOfElements="{block.n_cells}">',
        _item(f"{dataset}/cells", block.connectivity().shape, "Int", 8) + "</Topology>",
    ]
    if not block.is_placed:
        lines.append(_points(_item(f"{dataset}/points", block.points.shape, "Float", 8)))
    lines += [_attribute(block, field, mesh_file) for field, _ in block.fixed_fields]
    return "\n".join(lines)


def grid(block: Block, mesh_file: str) -> Callable[[float, str], str]:
    """Function that makes the text of a block at a time [s] in a file of its state.

    These texts differ in time and file alone.
    """
    time, state_file = "\0", "\1"
    lines = [f'<Grid Name="{block.name}"><Time Value="{time}"/>', geometry(block, mesh_file)]
    for field in block.all_fields:
        if field is POINTS:
            dataset = f"{state_file}:/{block.name}/{field.name}"
            lines.append(_points(_item(dataset, block.shape(field), "Float", 4)))
        else:
            lines.append(_attribute(block, field, state_file))
    text = "\n".join([*lines, "</Grid>"])
    return lambda at, file: text.replace(time, repr(at)).replace(state_file, file)


def _points(item: str) -> str:
    return f'<Geometry GeometryType="XYZ">\n{item}</Geometry>'


def _attribute(block: Block, field: FieldSpec, file: str) -> str:
    """A field of a block in one of the files."""
    number, precision = ("UChar", 1) if field.dtype == "<u1" else ("Float", 4)
    kind, center = ATTRIBUTE_TYPES[field.n_components], field.location.capitalize()
    item = _item(f"{file}:/{block.name}/{field.name}", block.shape(field), number, precision)
    head = f'<Attribute Name="{field.name}" AttributeType="{kind}" Center="{center}">'
    return f"{head}\n{item}</Attribute>"


def _item(dataset: str, shape: tuple[int, ...], number: str, precision: int) -> str:
    """Reference to a dataset."""
    sizes = " ".join(map(str, shape))
    return (
        f'<DataItem Format="HDF" Dimensions="{sizes}" NumberType="{number}"'
        f' Precision="{precision}">{dataset}</DataItem>'
    )
