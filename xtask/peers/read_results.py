"""Results and meshes as independent readers see them: VTK and meshio.

    python3 read_results.py PATH...

A directory of results: every VTU file of it is read by both, which must agree to the bit on points,
cells and fields, and every cell must have a positive size. Where there are quadrature points, what the
cells of the body have must be the means of theirs by volume. Two mesh files, the second made of the
first by `moreau convert`: points must agree, and cells but for their order. Needs the packages vtk and meshio.
"""

import pathlib
import sys

import meshio
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def read_by_vtk(path):
    """The grid of a VTU file; an error of the reader is one of ours."""
    errors = []
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("the reader reports an error"))
    reader.SetFileName(str(path))
    reader.Update()
    if errors:
        raise ValueError(errors[0])
    return reader.GetOutput()


def sizes(grid):
    """Lengths, areas or volumes of the cells."""
    measure = vtk.vtkCellSizeFilter()
    measure.SetInputData(grid)
    measure.Update()
    data = measure.GetOutput().GetCellData()
    names = {0: "VertexCount", 1: "Length", 2: "Area", 3: "Volume"}
    dimension = max((grid.GetCell(k).GetCellDimension() for k in range(grid.GetNumberOfCells())), default=0)
    return vtk_to_numpy(data.GetArray(names[dimension]))


def agree(what, ours, theirs):
    ours, theirs = numpy.asarray(ours), numpy.asarray(theirs)
    if ours.size != theirs.size or not numpy.array_equal(ours.ravel(), theirs.ravel(), equal_nan=True):
        raise ValueError(f"VTK and meshio disagree on {what}")


def check_result(path):
    grid = read_by_vtk(path)
    other = meshio.read(path)
    agree("the points", vtk_to_numpy(grid.GetPoints().GetData()), other.points)
    count = sum(len(block.data) for block in other.cells)
    if count != grid.GetNumberOfCells():
        raise ValueError(f"{grid.GetNumberOfCells()} cells by VTK, {count} by meshio")
    fields = grid.GetPointData()
    names = [fields.GetArrayName(k) for k in range(fields.GetNumberOfArrays())]
    for name in names:
        agree(name, vtk_to_numpy(fields.GetArray(name)), other.point_data[name])
    size = sizes(grid)
    if not (size > 0).all():
        raise ValueError(f"cell {int(numpy.argmin(size))} has the size {size.min()}")
    kinds = sorted({block.type for block in other.cells})
    print(f"{path}: {len(other.points)} points, {count} {'/'.join(kinds)}, size {size.sum():.9g}; {', '.join(names)}")


def check_points(path):
    """Quadrature points beside the body of the same increment: volumes, places and means."""
    body, points = meshio.read(path.with_name(path.name.replace("points", "body"))), meshio.read(path)
    number = numpy.concatenate(body.cell_data["cell"]).ravel().astype(int)
    cell, volume = points.point_data["cell"].ravel().astype(int), points.point_data["volume"].ravel()
    if not (volume > 0).all():
        raise ValueError("a point has no volume")
    volumes = numpy.bincount(cell, volume, len(number))
    corners = [body.points[nodes] for block in body.cells for nodes in block.data]
    inside = {n: (c.min(axis=0), c.max(axis=0)) for n, c in zip(number, corners)}
    low, high = (numpy.array([inside[c][k] for c in cell]) for k in (0, 1))
    if not ((low <= points.points) & (points.points <= high)).all():
        raise ValueError("a point is not within its cell")
    worst = 0.0
    for name in ["stress", "von_mises", "equivalent_plastic_strain"]:
        raw, mean = points.point_data[name], numpy.concatenate(body.cell_data[name])
        raw, mean = raw.reshape(len(cell), -1), mean.reshape(len(number), -1)
        found = [numpy.bincount(cell, volume * column, len(number)) / volumes for column in raw.T]
        difference = numpy.abs(numpy.array(found).T[number] - mean).max()
        worst = max(worst, difference / max(numpy.abs(raw).max(), numpy.finfo(float).tiny))
    if worst > 1e-12:
        raise ValueError(f"the means of the points are not what the cells have, by {worst:.3g}")
    print(f"{path}: {len(cell)} points in {len(number)} cells, volume {volume.sum():.9g}; means within {worst:.1g}")


def check_pair(first, second):
    one, two = meshio.read(first), meshio.read(second)
    points = numpy.zeros((len(one.points), 3))
    points[:, : one.points.shape[1]] = one.points
    if not numpy.array_equal(points, two.points):
        raise ValueError("points differ")
    largest = max(block.dim for block in one.cells)
    kinds = {block.type for block in one.cells if block.dim == largest}
    rows = lambda mesh, kind: sorted(map(tuple, mesh.cells_dict.get(kind, [])))
    for kind in kinds:
        if rows(one, kind) != rows(two, kind):
            raise ValueError(f"cells differ: {kind}")
    kinds = {kind: len(one.cells_dict[kind]) for kind in sorted(kinds)}
    print(f"{first}, {second}: {len(points)} points, {kinds}")


def main(paths):
    if not paths:
        print(__doc__)
        return 2
    failed = False
    jobs = []
    if len(paths) == 2 and all(p.is_file() for p in paths):
        jobs = [(check_pair, paths)]
    else:
        for path in paths:
            files = sorted(path.glob("*.vtu")) if path.is_dir() else [path]
            jobs += [(check_result, [file]) for file in files]
            pairs = [f for f in files if f.name.startswith("points_")]
            pairs = [f for f in pairs if f.with_name(f.name.replace("points", "body")).exists()]
            jobs += [(check_points, [file]) for file in pairs]
    for check, arguments in jobs:
        try:
            check(*arguments)
        except Exception as error:
            print(f"{' '.join(map(str, arguments))}: {error}", file=sys.stderr)
            failed = True
    return int(failed or not jobs)


if __name__ == "__main__":
    sys.exit(main([pathlib.Path(p) for p in sys.argv[1:]]))
