"""lammps_dcm: scenes, trajectories, analyses and pictures of deformable cells in LAMMPS.

    import lammps_dcm
    u = lammps_dcm.load("data.cells", "cells.dump")
    volume = lammps_dcm.CellVolume(u).run().results.volume     # (frames, cells), um^3
"""
__version__ = "0.2.0"    # of this Python package, not of the styles

_HOME = {"CellVolume": "analysis", "CellPressure": "analysis", "FaceArea": "analysis",
         "CellContacts": "analysis", "CellQuality": "analysis", "CellShape": "shape",
         "to_pyvista": "interop", "to_trimesh": "interop", "neighbor_graph": "interop",
         "cells_frame": "interop", "AtomBook": "frame_atoms", "Lumens": "lumen",
         "CellPolarity": "polarity", "read_data": "topology", "DumpFile": "reader",
         "Lineage": "lineage", "read_divisions": "lineage", "read_deaths": "lineage"}


def load(data=None, dump=None, dt=1.0, scan="auto", rename=None):
    """MDAnalysis Universe of a data file, a `dump custom` text file, or both.

    data: data file of `atom_style dcm`; it gives kinds, faces, bonds and rest volumes. Without
    it they come from dump columns of the names used in a data file (mol type kind radius v1 v2 v3
    region volume0), as far as they are there.
    dump: trajectory; atoms may come and go, absent ones have NaN positions. LAMMPS writes six
    digits by default: use `dump_modify ID format float %.15g` where volumes must be exact.
    dt: length of a step, s. scan: "auto", "all" or a list of frames, which ones are searched for
    new atom IDs, see DumpFile.first_seen.
    rename: dict of dump column -> name to use, such as {"c_face[2]": "contact_area"}.

    Attributes of atoms (resids, kinds, types, ...) do not change with the frame in MDAnalysis: they
    are those of the data file or of the first frame with the atom ID, which LAMMPS gives to other
    cells when cells divide, die or are converted. `AtomBook(universe).frame()` has those of the
    current frame, and all analyses use them.
    """
    import MDAnalysis
    import numpy as np

    from .reader import DCMDataReader, DCMDumpReader, DumpFile, merge_atoms
    from .topology import make_topology, read_data, type_labels

    if data is None and dump is None:
        raise ValueError("load() needs a data file, a dump or both")
    contents = None if data is None else read_data(data)
    masses, sections = (contents.masses, contents.sections) if contents else ({}, {})
    if dump is None:
        top = make_topology(contents.atoms, masses, sections.get("Bonds"),
                            sections.get("Dihedrals"))
        return MDAnalysis.Universe(top, str(data), format=DCMDataReader)
    labels = type_labels(contents) if contents else {}
    file = DumpFile(dump, rename)
    seen = file.first_seen(scan)
    file.close()
    ids = seen["id"]
    if contents:
        ids = np.union1d(ids, contents.atoms["id"])
    top = make_topology(merge_atoms(contents and contents.atoms, seen, ids, labels), masses,
                        sections.get("Bonds"), sections.get("Dihedrals"))
    return MDAnalysis.Universe(top, str(dump), format=DCMDumpReader, ids=ids, dt=dt, rename=rename,
                               labels=labels)


def __getattr__(name):
    """Import classes and readers when first used: MDAnalysis takes seconds to load."""
    if name in _HOME:
        from importlib import import_module

        return getattr(import_module(f".{_HOME[name]}", __name__), name)
    raise AttributeError(f"module 'lammps_dcm' has no attribute '{name}'")
