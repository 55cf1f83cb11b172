"""Opens a response database as ParaView would and prints what VTK finds, as JSON."""

import json
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

reader = vtkHDFReader()
if not reader.CanReadFile(sys.argv[1]):
    sys.exit("VTK cannot read " + sys.argv[1])
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
data = grid.GetPointData()
print(
    json.dumps(
        {
            "class": grid.GetClassName(),
            "points": vtk_to_numpy(grid.GetPoints().GetData()).tolist(),
            "triangles": [
                [grid.GetCell(i).GetPointId(j) for j in range(3)]
                for i in range(grid.GetNumberOfCells())
                if grid.GetCellType(i) == 5
            ],
            "data": {
                data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).tolist()
                for i in range(data.GetNumberOfArrays())
            },
        }
    )
)
