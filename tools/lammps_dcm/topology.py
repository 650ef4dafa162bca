"""Data files of `atom_style dcm`: text to arrays, and arrays to an MDAnalysis topology.

MDAnalysis' own parser takes the Atoms section for a standard style and stops at sections written
by fixes. This one knows the line

    id mol type kind radius x y z v1 v2 v3 region volume0 [ix iy iz]

and keeps every other section, known (`Bonds`, ...) as an array, unknown as text.
"""
import gzip
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from MDAnalysis.core.topology import Topology
from MDAnalysis.core.topologyattrs import (
    AtomAttr,
    Atomids,
    Atomtypes,
    Bonds,
    Dihedrals,
    Masses,
    Radii,
    Resids,
    Resnums,
    Segids,
)
from MDAnalysis.topology.base import TopologyReaderBase

SPHERE, CENTER, NODE, FACE, TRACER = 1, 2, 3, 4, 5
KIND_NAMES = {0: "unknown", 1: "sphere", 2: "center", 3: "node", 4: "face", 5: "tracer"}
REGION_NAMES = {0: "lateral", 1: "polar", 2: "apical", 3: "junction", 4: "basal"}

ATOM_COLUMNS = ("id", "mol", "type", "kind", "radius", "x", "y", "z", "v1", "v2", "v3", "region",
                "volume0")
IMAGE_COLUMNS = ("ix", "iy", "iz")
# sections that become arrays: name -> number of leading columns that are integers, or None
NUMERIC = {"Velocities": 1, "Bonds": 4, "Dihedrals": 6, "Masses": None}


class DataFileError(ValueError):
    """A data file that cannot be read; the message names file, line and remedy."""


class Kinds(AtomAttr):
    """Kind of atom: 1 sphere, 2 center, 3 node, 4 face, 5 tracer, 0 not known."""

    attrname, singular, per_object, dtype = "kinds", "kind", "atom", int

    @staticmethod
    def _gen_initial_values(na, nr, ns):
        return np.zeros(na, dtype=int)


class Regions(AtomAttr):
    """Surface region of a face: 0 lateral, 1 polar, 2 apical, 3 tight junction, 4 basal."""

    attrname, singular, per_object, dtype = "regions", "region", "atom", int

    @staticmethod
    def _gen_initial_values(na, nr, ns):
        return np.zeros(na, dtype=int)


class Vertices(AtomAttr):
    """Tags of a face's three nodes, counter-clockwise seen from outside; shape (n, 3), else 0."""

    attrname, singular, per_object = "vertices", "vertex_tags", "atom"

    @staticmethod
    def _gen_initial_values(na, nr, ns):
        return np.zeros((na, 3), dtype=int)


class RestVolumes(AtomAttr):
    """Rest volume V0 of a cell, um^3, on its center; 0 on every other atom."""

    attrname, singular, per_object, dtype = "volumes0", "volume0", "atom", float

    @staticmethod
    def _gen_initial_values(na, nr, ns):
        return np.zeros(na)


@dataclass
class DataFile:
    """Contents of a data file.

    atoms: dict of column name -> array (n,), sorted by id; integers stay integers, `type` is str.
    box: (3, 2), um, lower and upper bound per axis; tilt: (3,), um, xy xz yz.
    masses: dict of type -> mass. sections: name -> array (rows, columns) for Bonds, Dihedrals
    (id type tag ...) and Velocities (id vx vy vz), else the list of its lines.
    """

    path: str
    atoms: dict
    box: np.ndarray
    tilt: np.ndarray
    masses: dict = field(default_factory=dict)
    sections: dict = field(default_factory=dict)


def open_text(path):
    """Open a text file, gz or plain, with an error that names what is missing."""
    path = Path(path)
    if not path.exists():
        near = sorted(p.name for p in path.parent.glob("*"))[:8] if path.parent.exists() else []
        there = f"; {path.parent}/ holds {', '.join(near)}" if near else ""
        raise FileNotFoundError(f"no file {path}{there}")
    opener = gzip.open if path.suffix == ".gz" else open
    return opener(path, "rt", encoding="utf-8", errors="replace")


def read_data(path):
    """Read a LAMMPS data file of `atom_style dcm` (plain or .gz); returns a DataFile."""
    with open_text(path) as handle:
        lines = handle.read().splitlines()
    box = np.tile([-0.5, 0.5], (3, 1))
    tilt = np.zeros(3)
    counts, sections, style, where = {}, {}, {}, {}
    current = None
    for number, raw in enumerate(lines[1:], 2):
        line, _, comment = raw.partition("#")
        words = line.split()
        if not words:
            continue
        if re.match(r"[A-Z][a-zA-Z]*$", words[0]):
            current = " ".join(words)
            sections[current] = []
            style[current], where[current] = comment.strip(), number
        elif current is not None:
            sections[current].append(words)
        elif words[-1] in ("xhi", "yhi", "zhi"):
            box["xyz".index(words[-1][0])] = float(words[0]), float(words[1])
        elif words[-1] == "yz":
            tilt[:] = [float(w) for w in words[:3]]
        elif words[0].isdigit():
            counts[" ".join(words[1:])] = int(words[0])

    if "Atoms" not in sections:
        raise DataFileError(f"{path}: no Atoms section: is it a LAMMPS data file? A dump goes to "
                            "dump= (command line: without --data)")
    if style["Atoms"] not in ("", "dcm"):
        raise DataFileError(f"{path}:{where['Atoms']}: Atoms section of style "
                            f"'{style['Atoms']}': write it with `atom_style dcm`")
    expected = {"Atoms": "atoms", "Velocities": "atoms", "Bonds": "bonds",
                "Dihedrals": "dihedrals"}
    for name, count in expected.items():
        if name in sections and count in counts and len(sections[name]) != counts[count]:
            raise DataFileError(f"{path}: header announces {counts[count]} {count}, section "
                                f"{name} has {len(sections[name])} lines: the file is cut short "
                                "or was edited, write it again")
    atoms = parse_atoms(path, where["Atoms"], sections.pop("Atoms"))
    masses = {}
    for name, integers in NUMERIC.items():
        if name not in sections:
            continue
        rows = sections[name]
        if name == "Masses":
            masses = {w[0]: float(w[1]) for w in rows}
            continue
        if name in ("Bonds", "Dihedrals") and any(not w[1].isdigit() for w in rows):
            labels = {label: k for k, label in enumerate(sorted({w[1] for w in rows}), 1)}
            rows = [[w[0], labels[w[1]], *w[2:]] for w in rows]
        try:
            table = np.array(rows, dtype=float).reshape(len(rows), -1)
        except ValueError as err:
            raise DataFileError(f"{path}:{where[name]}: section {name}: {err}") from None
        whole = len(rows) and table.shape[1] == integers
        sections[name] = table.astype(int) if whole else table
    return DataFile(str(path), atoms, box, tilt, masses, sections)


def parse_atoms(path, first, rows):
    """Columns of the Atoms section, sorted by id; `first` is its line number for messages."""
    widths = {len(w) for w in rows}
    names = ATOM_COLUMNS
    if widths == {len(ATOM_COLUMNS) + 3}:
        names = ATOM_COLUMNS + IMAGE_COLUMNS
    elif widths - {len(ATOM_COLUMNS)}:
        raise DataFileError(
            f"{path}:{first}: Atoms lines have {sorted(widths)} columns, expected "
            f"{len(ATOM_COLUMNS)} ('{' '.join(ATOM_COLUMNS)}') or {len(ATOM_COLUMNS) + 3} with "
            "image flags: write the file with `atom_style dcm`")
    columns = list(zip(*rows)) if rows else [()] * len(names)
    atoms = {}
    for name, values in zip(names, columns):
        if name == "type":
            atoms[name] = np.array(values, dtype=object)
            continue
        floating = name in ("radius", "x", "y", "z", "volume0")
        try:
            atoms[name] = np.array(values, dtype=float if floating else int)
        except ValueError as err:
            raise DataFileError(f"{path}:{first}: column {name} of Atoms: {err}") from None
    order = np.argsort(atoms["id"], kind="stable")
    atoms = {name: values[order] for name, values in atoms.items()}
    twice = atoms["id"][1:][np.diff(atoms["id"]) == 0]
    if len(twice):
        raise DataFileError(f"{path}: atom ID {twice[0]} occurs twice")
    return atoms


def type_labels(contents):
    """Dict of number -> label of the atom types of a DataFile, empty if its atoms have numbers."""
    labels = {words[0]: words[1] for words in contents.sections.get("Atom Type Labels", ())}
    return labels if set(contents.atoms["type"]) & set(labels.values()) else {}


def type_names(column, labels):
    """Atom types (n,) as text, "0" for NaN: numbers become the label that `labels` (number ->
    label) has."""
    if column.dtype != object:
        column = np.where(np.isnan(column), 0, column).astype(int)
    words, at = np.unique(column.astype(str), return_inverse=True)
    words = ["0" if w in ("nan", "None") else labels.get(w, w) for w in words.tolist()]
    return np.array(words, dtype=object)[at]


def slot_lookup(ids):
    """Array `slot` with slot[id] = row of `id` in `ids`, -1 for ids that do not occur."""
    ids = np.asarray(ids, dtype=int)
    table = np.full(int(ids.max(initial=0)) + 1, -1)
    table[ids] = np.arange(len(ids))
    return table


def make_topology(atoms, masses=None, bonds=None, dihedrals=None):
    """MDAnalysis Topology from a dict of columns (those of ATOM_COLUMNS, sorted by id).

    bonds: (m, 4) and dihedrals: (m, 6) rows `id type tag ...`; rows with a tag that is not in
    `atoms` are left out.
    """
    n = len(atoms["id"])
    resids, resindex = np.unique(atoms["mol"], return_inverse=True)
    types = np.asarray(atoms["type"], dtype=object)
    masses = masses or {}
    attrs = [Atomids(atoms["id"]), Atomtypes(types), Kinds(atoms["kind"]),
             Radii(np.asarray(atoms["radius"], dtype=float)), Regions(atoms["region"]),
             Vertices(np.stack([atoms[v] for v in ("v1", "v2", "v3")], axis=1)),
             RestVolumes(np.asarray(atoms["volume0"], dtype=float)),
             Masses(np.array([masses.get(t, 1.0) for t in types], dtype=float),
                    guessed=not masses),
             Resids(resids), Resnums(resids.copy()),
             Segids(np.array(["SYSTEM"], dtype=object))]
    slots = slot_lookup(atoms["id"])
    for table, attr in ((bonds, Bonds), (dihedrals, Dihedrals)):
        if table is None or not len(table):
            continue
        tags = table[:, 2:]
        members = np.where(tags < len(slots), slots[np.minimum(tags, len(slots) - 1)], -1)
        keep = (members >= 0).all(axis=1)
        attrs.append(attr([tuple(m) for m in members[keep].tolist()],
                          types=[str(t) for t in table[keep, 1]]))
    return Topology(n, len(resids), 1, attrs=attrs, atom_resindex=resindex,
                    residue_segindex=None)


class DCMDataParser(TopologyReaderBase):
    """MDAnalysis topology parser for data files of `atom_style dcm`: topology_format='DCMDATA'."""

    format = "DCMDATA"

    def parse(self, **kwargs):
        """Read `self.filename`; returns a Topology."""
        data = read_data(self.filename)
        return make_topology(data.atoms, data.masses, data.sections.get("Bonds"),
                             data.sections.get("Dihedrals"))
