"""Draw the last frame of `lammps_dcm export` with ParaView, without a window.

    pvbatch view.py FOLDER PICTURE.png [COLUMN [LOW HIGH]]

COLUMN: what colors the cells, by default cell_pressure; LOW, HIGH: ends of the scale.
"""
import os
import sys

from paraview.simple import (
    ColorBy,
    CreateRenderView,
    GetColorTransferFunction,
    GetScalarBar,
    Glyph,
    PVDReader,
    SaveScreenshot,
    Show,
)

if len(sys.argv) not in (3, 4, 6):
    sys.exit(__doc__)
folder, picture = sys.argv[1:3]
column = sys.argv[3] if len(sys.argv) > 3 else "cell_pressure"
if not os.path.exists(os.path.join(folder, "cells.pvd")):
    sys.exit(f"{folder}: no cells.pvd in it: make it with `python -m lammps_dcm export`")

view = CreateRenderView(ViewSize=[1000, 800], UseColorPaletteForBackground=0,
                        Background=[1.0, 1.0, 1.0], OrientationAxesVisibility=0)
cells = PVDReader(FileName=os.path.join(folder, "cells.pvd"))
last = cells.TimestepValues[-1] if len(cells.TimestepValues) > 1 else 0.0
view.ViewTime = last
cells.UpdatePipeline(last)
arrays = cells.CellData.keys()
if column not in arrays:
    sys.exit(f"{column} is no column of the faces: they have {' '.join(arrays)}")
shown = Show(cells, view)
ColorBy(shown, ("CELLS", column))
scale = GetColorTransferFunction(column)
if len(sys.argv) > 5:
    scale.RescaleTransferFunction(float(sys.argv[4]), float(sys.argv[5]))
else:
    shown.RescaleTransferFunctionToDataRange(False)
shown.SetScalarBarVisibility(view, True)
bar = GetScalarBar(scale, view)
bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]

if os.path.exists(os.path.join(folder, "spheres.pvd")):
    spheres = PVDReader(FileName=os.path.join(folder, "spheres.pvd"))
    # ParaView's sphere has the radius 1/2
    balls = Glyph(Input=spheres, GlyphType="Sphere", ScaleArray=["POINTS", "radius"],
                  ScaleFactor=2.0, GlyphMode="All Points", OrientationArray=["POINTS", "No array"])
    balls.GlyphType.ThetaResolution = balls.GlyphType.PhiResolution = 24
    gray = Show(balls, view)
    ColorBy(gray, None)
    gray.DiffuseColor = [0.75, 0.75, 0.75]

view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -0.5, 1], [0, 0, 0], [0, 1, 0]
view.ResetCamera(True)
SaveScreenshot(picture, view, ImageResolution=[1000, 800])
print(f"wrote {picture}: time {last:g}")
