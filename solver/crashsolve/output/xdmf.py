"""The text of states.xdmf: XDMF 2 as the reader of ParaView 5.11 takes it."""

from collections.abc import Iterable

from crashsolve.output.blocks import CELL_TYPES, Block

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
    """Topology and points of a block, the same at every time."""
    place = f"{mesh_file}:/{block.name}"
    kind = "Mixed"
    if len(block.cells) == 1:
        cell = CELL_TYPES[block.cells[0][0]]
        kind = cell.xdmf
        if cell.open_ended:
            kind += f'" NodesPerElement="{cell.corners}'
    return "\n".join(
        [
            f'<Topology TopologyType="{kind}" NumberOfElements="{block.n_cells}">',
            _item(f"{place}/cells", block.connectivity().shape, "Int", 8),
            '</Topology><Geometry GeometryType="XYZ">',
            _item(f"{place}/points", block.points.shape, "Float", 8),
            "</Geometry>",
        ]
    )


def grid(block: Block, block_geometry: str, time: float, state_file: str) -> str:
    """One block at one time."""
    lines = [f'<Grid Name="{block.name}"><Time Value="{time!r}"/>', block_geometry]
    for field in block.all_fields:
        number, precision = ("UChar", 1) if field.dtype == "<u1" else ("Float", 4)
        kind, center = ATTRIBUTE_TYPES[field.n_components], field.location.capitalize()
        place = f"{state_file}:/{block.name}/{field.name}"
        lines += [
            f'<Attribute Name="{field.name}" AttributeType="{kind}" Center="{center}">',
            _item(place, block.shape(field), number, precision) + "</Attribute>",
        ]
    return "\n".join([*lines, "</Grid>"])


def _item(place: str, shape: tuple[int, ...], number: str, precision: int) -> str:
    """Reference to a dataset."""
    sizes = " ".join(map(str, shape))
    return (
        f'<DataItem Format="HDF" Dimensions="{sizes}" NumberType="{number}"'
        f' Precision="{precision}">{place}</DataItem>'
    )
