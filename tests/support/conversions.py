"""Decks in which cells change their form; used by test_convert.py, test_convert_rules.py."""

from .cycle_decks import growth


def convert(rule, options="every 10 mesh icosphere 1"):
    return f"fix convert all dcm/convert dcm 1 2 3 1 1 cbm 4 {rule} {options}\n"


def cells_dump(scenes, every=1):
    """One line per cell: kind (1 deformable), volumes, pressure, center."""
    return (
        "group cells type 1 4\ncompute of cells dcm/cell volume0 volume pressure x y z\n"
        + scenes.dump("id mol type c_of[1] c_of[2] c_of[3] xu yu zu", every, "cells.txt", "cells")
    )


def cells(frame):
    """molecule -> (deformable, V0, V, p, x); new nodes are in the groups of the sphere."""
    columns = [frame[name] for name in ("mol", "type", "c_of[1]", "c_of[2]", "c_of[3]")]
    return {
        int(m): (t == 1, V0, V, p, frame.x[k])
        for k, (m, t, V0, V, p) in enumerate(zip(*columns, strict=True))
        if t in (1, 4)
    }


def still(scene, rule, options="every 10 mesh icosphere 1", grow=""):
    """Cells that do not move; the rest of the deck follows."""
    return (
        scene.head()
        + scene.cortex()
        + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
        + scene.volume()
        + growth(scene, grow)
        + convert(rule, options)
        + "timestep 1.0\n"
    )


def row_of_spheres(scenes, n=5, distance=14.0, boundary="f f f"):
    scene = scenes.Scene((distance * n / 2 + 2, 12.0, 12.0), boundary)
    for k in range(n):
        scene.cbm(distance * (k - (n - 1) / 2), 0.3, -0.2, 5.0)
    return scene


def deformable(frame):
    return {m for m, it in cells(frame).items() if it[0]}
