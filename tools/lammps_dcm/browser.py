"""A frame as one HTML file that a browser shows and turns, without a network.

trame-vtk has the viewer, vtk.js in one file, and what writes a VTK scene in the viewer's form; the
title and the legend are HTML above it. Nothing is drawn here, so that no OpenGL is needed.
"""
import html
import io
import json
import re
import zipfile

import numpy as np

from .drawing import build_plotter
from .text import write_text

SPHERE_TRIANGLES = 400_000    # most triangles of all spheres together, so that the file stays small
STYLE = ("position:absolute;left:12px;top:10px;z-index:9;font:14px sans-serif;color:#222;"
         "background:rgba(255,255,255,.8);padding:6px 10px;pointer-events:none")
# the viewer empties what it fills, by default the whole body
CONTENT = '<div class="content" style="position:absolute;inset:0"></div>'


def scene_archive(plotter):
    """The scene of a pyvista.Plotter as the zip archive that the viewer of trame-vtk loads."""
    from trame_vtk.modules.vtk.serializers import (
        SynchronizationContext,
        extract_array_hash,
        initialize_serializers,
        reference_id,
        serialize,
    )

    initialize_serializers()
    window, context = plotter.render_window, SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    camera = window.GetRenderers().GetFirstRenderer().GetActiveCamera()
    scene = serialize(None, window, "1", context, 1)
    scene["extra"] = {"vtkRefId": reference_id(window), "centerOfRotation": camera.GetFocalPoint(),
                      "camera": reference_id(camera)}
    arrays = {entry["hash"]: entry | {"content": context.get_cached_data_array(entry["hash"])}
              for entry in extract_array_hash(scene)}
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    return archive.getvalue()


def legend_html(picture, cmap):
    """Title, names of colors and color scale of a Picture."""
    lines = [f"<b>{html.escape(picture.title)}</b>"]
    square = '<span style="display:inline-block;width:.8em;height:.8em;background:{}"></span> {}'
    lines += [square.format(color, html.escape(label)) for label, color in picture.legend.items()]
    if picture.bar:
        import matplotlib
        from matplotlib.colors import to_hex

        title, low, high = picture.bar
        colors = ",".join(to_hex(c) for c in matplotlib.colormaps[cmap](np.linspace(0, 1, 16)))
        lines += [html.escape(title), '<span style="display:block;width:160px;height:10px;'
                  f'background:linear-gradient(90deg,{colors})"></span>'
                  f'<span style="float:left">{low:.4g}</span>'
                  f'<span style="float:right">{high:.4g}</span>']
    return f'<div id="legend" style="{STYLE}">{"<br>".join(lines)}</div>'


def write_html(picture, path, cmap="viridis", **options):
    """Write a Picture as an HTML file; options: those of build_plotter."""
    from trame_vtk.tools.vtksz2html import write_html as embed
    from vtkmodules.vtkCommonCore import vtkLogger

    # it looks for a display and complains of a missing one, though nothing is drawn
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    sides = int(np.sqrt(0.5 * SPHERE_TRIANGLES / max(1, len(picture.centers))))
    plotter = build_plotter(picture, round_=min(40, max(6, sides)), **options)
    page = io.StringIO()
    embed(scene_archive(plotter), page)
    plotter.close()
    head, body, rest = page.getvalue().partition("<body>")
    head = re.sub("<title>.*?</title>", f"<title>{html.escape(picture.title)}</title>", head)
    write_text(path, head + body + CONTENT + legend_html(picture, cmap) + rest)
