"""A picture of results as ParaView shows them.

    pvpython in_paraview.py DIR OUT.png [FIELD] [WARP]

Opens DIR/result.pvd at its last time, deforms its parts by WARP times their displacements (1 unless given)
and colours those that have FIELD (von_mises unless given) by it; of the others the edges. Prints times, parts and
fields with their ranges; fails where a part has no displacement or none has the field. Without a display:
in xvfb-run, or a pvpython that draws off the screen.
"""

import os
import pathlib
import sys
import traceback

from paraview.vtk import vtkCompositeDataSet
from paraview import servermanager, simple


def leaves(data, name=None):
    """The parts of a collection with their names."""
    if not data.IsA("vtkMultiBlockDataSet"):
        return [(name, data)]
    found = []
    for k in range(data.GetNumberOfBlocks()):
        own = data.GetMetaData(k).Get(vtkCompositeDataSet.NAME()) if data.HasMetaData(k) else None
        found += leaves(data.GetBlock(k), own or name)
    return found


def describe(name, part):
    """Prints what a part has; the names of its fields at points."""
    print(f"{name}: {part.GetNumberOfPoints()} points, {part.GetNumberOfCells()} cells")
    for where, arrays in [("points", part.GetPointData()), ("cells", part.GetCellData())]:
        for k in range(arrays.GetNumberOfArrays()):
            array = arrays.GetArray(k)
            ranges = [array.GetRange(i) for i in range(array.GetNumberOfComponents())]
            shown = ", ".join(f"{low:.6g} to {high:.6g}" for low, high in ranges)
            print(f"  {where} {array.GetName()}: {shown}")
    arrays = part.GetPointData()
    return [arrays.GetArrayName(k) for k in range(arrays.GetNumberOfArrays())]


def draw(directory, out, field="von_mises", factor="1"):
    reader = simple.PVDReader(FileName=str(pathlib.Path(directory) / "result.pvd"))
    times = list(reader.TimestepValues)
    print("times", *(f"{time:.6g}" for time in times))
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewTime, view.ViewSize = times[-1], [1200, 800]
    warped = simple.WarpByVector(Input=reader, Vectors=["POINTS", "displacement"], ScaleFactor=float(factor))
    warped.UpdatePipeline(times[-1])
    parts = leaves(servermanager.Fetch(warped))
    fields = {name: describe(name, part) for name, part in parts}
    without = [name for name in fields if "displacement" not in fields[name]]
    coloured = [name for name in fields if field in fields[name]]
    if without or not coloured:
        raise ValueError(f"no displacement: {without}; coloured by {field}: {coloured}")
    for name in sorted(fields, key=coloured.__contains__):
        one = simple.ExtractBlock(Input=warped, Selectors=[f"/Root/{name}"])
        shown = simple.Show(one, view)
        if name not in coloured:
            shown.SetRepresentationType("Feature Edges")
            continue
        simple.ColorBy(shown, ("POINTS", field))
        if name == "points":
            shown.RenderPointsAsSpheres, shown.PointSize = 1, 6
        shown.RescaleTransferFunctionToDataRange(True, False)
    shown.SetScalarBarVisibility(view, True)
    low, high = dict(parts)[coloured[0]].GetBounds()[4:]
    if high > low:
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [3, 2, 2.5], [0, 0, 0], [0, 1, 0]
    simple.ResetCamera(view)
    simple.SaveScreenshot(out, view, ImageResolution=[1200, 800])


if __name__ == "__main__":
    if not 3 <= len(sys.argv) <= 5:
        print(__doc__)
        sys.exit(2)
    status = 0
    try:
        draw(*sys.argv[1:])
    except Exception:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    # Some drivers crash when ParaView closes its window, after all is done.
    os._exit(status)
