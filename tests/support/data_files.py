"""Synthetic data and dump files, written here without the package under test."""

import numpy as np

from .meshes import icosphere


class Scene:
    """Atoms of `atom_style dcm`, tags laid out per cell: center, nodes, faces."""

    def __init__(self, box=((-50, 50),) * 3):
        self.box, self.rows, self.bonds = np.array(box, dtype=float), [], []

    def dcm(self, center, shape, level=2, type=1, volume0=500.0):
        """Deformable cell; shape: radius or half-axes, um. Returns its molecule ID."""
        nodes, faces = icosphere(level)
        nodes = nodes * np.broadcast_to(shape, 3) + center
        mol, first = self.molecule(), len(self.rows) + 2
        self.add(mol, type, 2, 0, center, (0, 0, 0), volume0)
        for p in nodes:
            self.add(mol, type + 1, 3, 0, p)
        for f in faces:
            self.add(mol, type + 2, 4, 0.5, nodes[f].mean(axis=0), tuple(f + first))
            self.bonds += [(f[k] + first, f[k - 1] + first) for k in range(3) if f[k] < f[k - 1]]
        return mol

    def cbm(self, center, radius, type=4):
        """Sphere cell. Returns its molecule ID."""
        mol = self.molecule()
        self.add(mol, type, 1, radius, center)
        return mol

    def molecule(self):
        return 1 + max((r["mol"] for r in self.rows), default=0)

    def add(self, mol, type, kind, radius, x, v=(0, 0, 0), volume0=0.0):
        self.rows.append(dict(id=len(self.rows) + 1, mol=mol, type=type, kind=kind, radius=radius,
                              x=x[0], y=x[1], z=x[2], v1=v[0], v2=v[1], v3=v[2], region=0,
                              volume0=volume0))

    def wrapped(self, row):
        lo, length = self.box[:, 0], self.box[:, 1] - self.box[:, 0]
        x = np.array([row["x"], row["y"], row["z"]])
        x = lo + np.mod(x - lo, length)
        return {**row, "x": x[0], "y": x[1], "z": x[2]}

    def data_file(self, path, wrap=False, images=False):
        """Write a data file with the sections that fix dcm/cell adds."""
        names = ["id", "mol", "type", "kind", "radius", "x", "y", "z", "v1", "v2", "v3", "region",
                 "volume0"]
        out = ["LAMMPS data file via write_data", "", f"{len(self.rows)} atoms",
               "4 atom types", f"{len(self.bonds)} bonds", "1 bond types", ""]
        out += [f"{lo:.17g} {hi:.17g} {a}lo {a}hi" for (lo, hi), a in zip(self.box, "xyz")]
        out += ["", "Masses", ""] + [f"{k} 1" for k in range(1, 5)]
        out += ["", "Atoms # dcm", ""]
        for r in reversed(self.rows):    # LAMMPS does not sort
            r = self.wrapped(r) if wrap else r
            out.append(" ".join(f"{r[n]:.17g}" for n in names) + (" 0 0 0" if images else ""))
        out += ["", "Velocities", ""]
        out += [f"{r['id']} {r['id'] * 0.5} 0 0" for r in reversed(self.rows)]
        if self.bonds:
            out += ["", "Bonds", ""]
            out += [f"{k} 1 {a} {b}" for k, (a, b) in enumerate(self.bonds, 1)]
            out += ["", "Something New", "", "1 two 3"]
        path.write_text("\n".join(out) + "\n")
        return path

    def frame(self, step, columns="id type x y z", wrap=False, keep=lambda r: True,
              flags="pp pp pp", shuffle=0, **extra):
        """Text of one dump frame; extra: column name -> function of the row."""
        rows = [self.wrapped(r) if wrap else r for r in self.rows if keep(r)]
        np.random.default_rng(shuffle).shuffle(rows)
        names = columns.split() + list(extra)
        out = ["ITEM: TIMESTEP", str(step), "ITEM: NUMBER OF ATOMS", str(len(rows)),
               f"ITEM: BOX BOUNDS {flags}"]
        out += [f"{lo:.17g} {hi:.17g}" for lo, hi in self.box]
        out.append("ITEM: ATOMS " + " ".join(names))
        for r in rows:
            values = {**r, **{k: f(r) for k, f in extra.items()}}
            out.append(" ".join(v if isinstance(v, str) else f"{v:.17g}"
                                for v in (values[n] for n in names)))
        return "\n".join(out) + "\n"


def section(text, name):
    """Lines of a section of a data file."""
    body = text.partition(f"\n{name}\n\n")[2]
    return body.partition("\n\n")[0].splitlines()
