"""What a picture shows and what it says: framing, scale bar, time, colors by themselves, movies."""
import numpy as np
import pytest
from PIL import Image

import lammps_dcm
from lammps_dcm.__main__ import main
from lammps_dcm.drawing import LINE, axes_of, extent, fit, nice_length
from lammps_dcm.frame_atoms import AtomBook
from lammps_dcm.render import (
    evenly,
    make_picture,
    one_scale,
    telling_color,
    telling_view,
    time_text,
)
from lammps_dcm.run_folder import find_run

COLUMNS = "id mol type x y z radius kind v1 v2 v3"


def frame(scene, step, wrap=False, **extra):
    """A frame that tells the shapes of cells; extra: column -> function of the row."""
    columns = " ".join(c for c in COLUMNS.split() if c not in extra)
    return scene.frame(step, columns, wrap=wrap, **extra)


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def universe(tmp_path, text):
    (tmp_path / "dump").write_text(text)
    return lammps_dcm.load(None, tmp_path / "dump")


@pytest.mark.parametrize("engine", ["auto", "matplotlib"])
@pytest.mark.parametrize("view", ["xy", "yz", "iso"])
def test_nothing_is_cut_off_and_the_scale_holds(scene, tmp_path, engine, view):
    """A long row of cells: all of it is in the picture, and as long as the scale bar says."""
    for k in range(5):
        scene.cbm((20 * k - 40, 0, 0), 5.0)
    (tmp_path / "dump").write_text(frame(scene, 0))
    out = tmp_path / "p.png"
    size = 500
    assert main(["render", str(tmp_path / "dump"), "-o", str(out), "--size", str(size), "--view",
                 view, "--engine", engine, "--color", "cell"]) == 0
    image = pixels(out)
    colored = np.ptp(image, axis=2) > 25
    rows, columns = np.nonzero(colored)
    assert rows.min() > 0 and rows.max() < size - 1
    assert columns.min() > 0 and columns.max() < size - 1
    # below the scene there is the bar, black, its left end in the corner
    strip = (image[size - round(1.5 * LINE * size):, :size // 2] < 60).all(axis=2)
    bar = strip.sum(axis=1).max()
    right = axes_of(view)[0]
    wide = 10.0 + 80.0 * abs(right[0])
    um_per_pixel = wide / (np.ptp(columns) + 1)
    assert bar * um_per_pixel == pytest.approx(nice_length(0.25 * size * um_per_pixel), rel=0.04)


def test_window_of_several_frames():
    window = fit([np.array([[0, 0, 0], [10, 10, 1]]), np.array([[-30, 2, 0], [0, 4, 1]])], 600,
                 square=False)
    assert window.middle[0] == -10.0 and window.width * window.um_per_pixel > 40.0
    assert window.height < window.width and window.height % 2 == 0
    # the scene is between the strips of text above and below
    above = window.middle[1] + 0.5 * window.height * window.um_per_pixel - 10.0
    below = 0.0 - (window.middle[1] - 0.5 * window.height * window.um_per_pixel)
    assert above > 1.5 * LINE * 600 * window.um_per_pixel
    assert below > 2.5 * LINE * 600 * window.um_per_pixel


def test_round_lengths_and_times():
    assert [nice_length(x) for x in (0.99, 1.0, 4.9, 5.0, 37.0, 260.0)] == [0.5, 1, 2, 5, 20, 200]
    assert [time_text(t) for t in (0.0, 12.5, 179.0, 600.0, 7200.0)] == [
        "0 s", "12.5 s", "179 s", "10.0 min", "2.00 h"]
    assert evenly(41, 30)[0] == 0 and evenly(41, 30)[-1] == 40 and len(evenly(41, 30)) <= 30
    assert evenly(3, 30) == [0, 1, 2] and evenly(1, 30) == [0]


def test_cells_at_periodic_borders_are_whole(make_scene, tmp_path):
    """A cell in the corner of the box, its nodes wrapped into the box as LAMMPS does."""
    scene = make_scene()
    scene.dcm((49, 49, 49), 5.0, level=2)
    u = universe(tmp_path, frame(scene, 0, wrap=True))
    assert np.ptp(u.trajectory.ts.data["xyz"], axis=0).min() > 90.0    # torn in the dump
    low, high = extent(make_picture(u, "cell"), "xy")
    assert high - low == pytest.approx([10.0] * 3, rel=1e-6)


def test_time_in_the_picture(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0)
    text = frame(scene, 100)
    assert make_picture(universe(tmp_path, text), "cell").title == "step 100"
    assert make_picture(universe(tmp_path, text), "cell", dt=2.5).title == "4.2 min"
    u = universe(tmp_path, "ITEM: TIME\n7.5\n" + text)
    assert make_picture(u, "cell", dt=2.5).title == "7.5 s"    # the dump knows better


def test_pressure_and_generation_from_the_dump(scene, tmp_path):
    scene.dcm((-6, 0, 0), 5.0)
    scene.dcm((6, 0, 0), 5.0)
    # compute dcm/cell gives values on the centers only
    more = {"pressure": lambda r: 0.1 * r["mol"] * (r["kind"] == 2),
            "generation": lambda r: (r["mol"] + 3) * (r["kind"] == 2)}
    u = universe(tmp_path, frame(scene, 0, **more))
    picture = make_picture(u, "pressure")
    assert picture.bar == ("pressure, kPa", pytest.approx(0.1), pytest.approx(0.2))
    first, second = make_picture(u, "generation"), make_picture(u, "generation", names={})
    assert list(first.legend) == ["generation 4", "generation 5"]
    assert (first.face_rgb == second.face_rgb).all()
    other = make_picture(u, "pressure", limits=(0.2, 0.6))
    one_scale([picture, other], "viridis")
    assert picture.bar == other.bar and (picture.face_rgb == other.face_rgb).all()


@pytest.mark.parametrize("columns, color", [
    ({}, "cell"), ({"pressure": lambda r: r["mol"] / 8.0}, "pressure"),
    ({"pressure": lambda r: r["mol"], "generation": lambda r: r["mol"] % 2}, "generation"),
    ({"type": lambda r: r["type"] + 10 * (r["mol"] == 1)}, "type"),
    ({"region": lambda r: 2 * (r["x"] > 0)}, "region"),
    ({"mark": lambda r: r["kind"] == 4 and r["x"] > 3}, "mark")])
def test_color_by_what_tells(scene, tmp_path, columns, color):
    scene.dcm((-6, 0, 0), 5.0)
    scene.dcm((6, 0, 0), 5.0)
    u = universe(tmp_path, frame(scene, 0, **columns))
    book = AtomBook(u)
    assert telling_color(u, book) == color
    assert make_picture(u, color, book=book).face_rgb.std() > 0.0    # not of a single color


def test_flat_scenes_are_seen_from_above(scene, tmp_path):
    for k in range(9):
        scene.cbm((10 * (k % 3), 10 * (k // 3), 0), 5.0)
    u = universe(tmp_path, frame(scene, 0))
    assert telling_view(u, AtomBook(u)) == "xy"
    scene.cbm((0, 0, 15), 5.0)
    u = universe(tmp_path, frame(scene, 0))
    assert telling_view(u, AtomBook(u)) == "iso"


def test_movie_of_a_folder(scene, tmp_path):
    """The cell moves: every frame differs, and the last one is the picture's."""
    scene.dcm((-6, 0, 0), 5.0)
    scene.dcm((6, 0, 0), 5.0)
    frames = [frame(scene, k, x=lambda r, k=k: r["x"] + 3.0 * k * (r["mol"] == 1))
              for k in range(7)]
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "a.dump").write_text("".join(frames))
    (folder / "cells.dump").write_text(scene.frame(0, "id x y z"))
    out = tmp_path / "m.gif"
    assert main(["render", str(folder), "-o", str(tmp_path / "p.png"), "--movie", str(out),
                 "--frames", "5", "--size", "400", "--color", "auto", "--view", "auto"]) == 0
    with Image.open(out) as movie:
        assert movie.n_frames == 5 and movie.size[0] == 200
        seen = []
        for k in range(5):
            movie.seek(k)
            image = np.asarray(movie.convert("RGB")).astype(int)
            columns = np.nonzero((np.ptp(image, axis=2) > 40).any(axis=0))[0]
            seen.append(columns.min())
    assert seen == sorted(seen) and seen[0] < seen[-1]    # one window, so that the motion shows


def test_a_dump_before_anything_is_there(scene, tmp_path, capsys):
    """Frames without cells are left out of the movie, but an error as the picture."""
    scene.cbm((0, 0, 0), 5.0)
    empty = frame(scene, 0).replace(f"ATOMS\n{len(scene.rows)}", "ATOMS\n0")
    empty = empty[:empty.index("\n", empty.index("ITEM: ATOMS")) + 1]
    (tmp_path / "dump").write_text(empty + frame(scene, 5) + frame(scene, 6))
    words = ["render", str(tmp_path / "dump"), "-o", str(tmp_path / "p.png"), "--engine",
             "matplotlib", "--size", "200", "--movie", str(tmp_path / "m.gif")]
    assert main(words) == 0
    with Image.open(tmp_path / "m.gif") as movie:
        assert movie.n_frames == 2
    assert main([*words, "--frame", "0"]) == 1
    assert "nothing to draw" in capsys.readouterr().err


def test_which_files_of_a_folder_are_drawn(scene, tmp_path):
    scene.dcm((0, 0, 0), 5.0)
    with pytest.raises(ValueError, match="nothing to draw"):
        find_run(tmp_path)
    (tmp_path / "notes.data").write_text("not of LAMMPS\n")
    (tmp_path / "positions.dump").write_text(scene.frame(0, "id x y z") * 3)
    (tmp_path / "empty.dump").write_text("")
    with pytest.raises(ValueError, match="nothing to draw"):
        find_run(tmp_path)
    data = str(scene.data_file(tmp_path / "x.data"))
    assert find_run(tmp_path) == (str(tmp_path / "positions.dump"), data)
    (tmp_path / "all.dump").write_text(frame(scene, 0))
    assert find_run(tmp_path) == (str(tmp_path / "all.dump"), None)
    (tmp_path / "all.dump").unlink()
    (tmp_path / "positions.dump").unlink()
    assert find_run(tmp_path) == (None, data)
