"""Trajectories: `dump custom` text files of a changing number of atoms, and data files.

An atom keeps its slot for the whole trajectory; a frame that lacks it has NaN there. Every column
of the dump is in `ts.data[name]`, shape (n_atoms,), in double precision.
"""
import gzip
import io
import re
import warnings
from pathlib import Path

import numpy as np
from MDAnalysis.coordinates.base import ReaderBase, SingleFrameReaderBase
from MDAnalysis.lib.mdamath import triclinic_box
from MDAnalysis.lib.util import store_init_arguments
from tqdm import tqdm

from .topology import ATOM_COLUMNS, open_text, read_data, slot_lookup, type_names

COORDINATES = (("xu", "yu", "zu"), ("x", "y", "z"), ("xsu", "ysu", "zsu"), ("xs", "ys", "zs"))
# names in `compute property/atom` -> names in a data file
ALIASES = {"vertex1": "v1", "vertex2": "v2", "vertex3": "v3"}
MARK = b"ITEM: TIMESTEP"
TIME_LINES = 64    # bytes before it in which `dump_modify time yes` writes the time


class DumpError(ValueError):
    """A dump that cannot be read; the message names file, frame and remedy."""


def find_frames(path, handle):
    """Byte offsets of all frames in an open binary file, the end of the file last."""
    offsets, base, tail = [], 0, b""
    total = None if str(path).endswith(".gz") else Path(path).stat().st_size
    bar = tqdm(total=total, desc=f"indexing {Path(path).name}", unit="B", unit_scale=True,
               disable=None if total is None or total > 2**26 else True, leave=False)
    while True:
        try:
            chunk = handle.read1(2**22)    # read() would lose what precedes a damaged gz end
        except EOFError:
            warnings.warn(f"{path}: the gz file is cut short", stacklevel=2)
            chunk = b""
        if not chunk:
            break
        bar.update(len(chunk))
        text = tail + chunk
        at = text.find(MARK)
        while at >= 0:
            offsets.append(base + at)
            at = text.find(MARK, at + len(MARK))
        keep = min(len(text), len(MARK) - 1)
        base += len(text) - keep
        tail = text[-keep:]
    bar.close()
    return offsets + [base + len(tail)]


class Frame:
    """One frame as text, header parsed: step, time, natoms, box (3, 2) um, tilt (3,) um,
    periodic (3,) bool, columns (names), body (bytes, one line an atom). That of a `dump local` has
    entries in the place of atoms."""

    def __init__(self, text, where):
        self.where = where
        self.time = None
        self.columns = None
        lines, at = [], 0
        while True:
            end = text.find(b"\n", at)
            if end < 0:
                raise DumpError(f"{where}: the header is cut short")
            line, at = text[at:end].decode("utf-8", "replace").strip(), end + 1
            lines.append(line)
            if line.startswith(("ITEM: ATOMS", "ITEM: ENTRIES")):
                break
        self.body = text[at:]
        self.tilt = np.zeros(3)
        try:
            for n, line in enumerate(lines):
                if line.startswith("ITEM: TIMESTEP"):
                    self.step = int(lines[n + 1])
                elif line.startswith(("ITEM: NUMBER OF ATOMS", "ITEM: NUMBER OF ENTRIES")):
                    self.natoms = int(lines[n + 1])
                elif line.startswith("ITEM: BOX BOUNDS"):
                    self._parse_box(line.split()[3:], lines[n + 1:n + 4])
            self.columns = lines[-1].split()[2:]
            if not all(hasattr(self, name) for name in ("step", "natoms", "box")):
                raise ValueError("it lacks TIMESTEP, NUMBER OF ATOMS or BOX BOUNDS")
        except (IndexError, ValueError) as err:
            raise DumpError(f"{where}: not the header of a text dump ({err}): use "
                            "`dump custom` or `dump atom` without `binary`") from None

    def _parse_box(self, flags, rows):
        if "abc" in flags:
            raise ValueError("general triclinic box: use `dump_modify triclinic/general no`")
        rows = np.array([r.split() for r in rows], dtype=float)
        if rows.shape[1] == 3:
            xy, xz, yz = self.tilt[:] = rows[:, 2]
            rows[0, 0] -= min(0.0, xy, xz, xy + xz)
            rows[0, 1] -= max(0.0, xy, xz, xy + xz)
            rows[1, 0] -= min(0.0, yz)
            rows[1, 1] -= max(0.0, yz)
        self.box = rows[:, :2]
        self.periodic = np.array([f == "pp" for f in flags[-3:]])

    @property
    def lines(self):
        """Number of complete atom lines that are there."""
        return self.body.count(b"\n")

    def table(self):
        """Dict of column name -> array (natoms,), float, or object where it is no number."""
        if self.lines < self.natoms:
            raise self._damaged()
        shape = self.natoms, len(self.columns)
        try:
            values = np.loadtxt(io.BytesIO(self.body), ndmin=2, comments=None,
                                max_rows=self.natoms) if self.natoms else np.zeros(shape)
        except ValueError:    # text in a column, or lines of unequal length
            return self._mixed_table()
        if values.shape != shape:
            raise self._damaged()
        return {name: values[:, k] for k, name in enumerate(self.columns)}

    def _mixed_table(self):
        rows = [line.split() for line in self.body.decode().splitlines()[:self.natoms]]
        if any(len(row) != len(self.columns) for row in rows):
            raise self._damaged()
        found = {}
        for name, column in zip(self.columns, zip(*rows)):
            try:
                found[name] = np.array(column, dtype=float)
            except ValueError:
                found[name] = np.array(column, dtype=object)
        return found

    def _damaged(self):
        return DumpError(f"{self.where}: {self.lines} of {self.natoms} atom lines are there, or "
                         "not all are whole: the dump is cut short or damaged here")


class DumpFile:
    """Random access to the frames of a text dump, plain or .gz.

    A last frame that is not complete is left out, with a warning that names it. rename: dict of
    column in the file -> name to use.
    """

    def __init__(self, path, rename=None):
        self.path = str(path)
        self.rename = {**ALIASES, **(rename or {})}
        open_text(path).close()    # teaches which files are there
        self._file = None
        self.offsets = find_frames(self.path, self._handle())
        if len(self.offsets) < 2:
            with open_text(path) as handle:
                is_data = handle.readline().startswith("LAMMPS data file")
            raise DumpError(f"{path}: no 'ITEM: TIMESTEP': " + (
                "this is a data file, give it as data (command line: --data)" if is_data else
                "not a text dump of LAMMPS, use `dump custom`"))
        last = len(self) - 1
        try:
            frame = self.frame(last)
            problem = None if frame.lines >= frame.natoms else (
                f"step {frame.step} has {frame.lines} of {frame.natoms} atom lines")
        except DumpError as err:
            problem = str(err)
        if problem:
            text = (f"{path}: the last frame ({last}) is not complete ({problem}): LAMMPS was "
                    "stopped while writing it, or still runs")
            if last == 0:
                raise DumpError(text)
            warnings.warn(text + "; it is left out", stacklevel=2)
            self.offsets.pop()

    def _handle(self):
        if self._file is None:
            self._file = (gzip.open if self.path.endswith(".gz") else open)(self.path, "rb")
        return self._file

    def __len__(self):
        return len(self.offsets) - 1

    def __getstate__(self):
        return {**self.__dict__, "_file": None}

    def close(self):
        """Close the file; it opens again when needed."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def frame(self, number):
        """Frame `number`, 0 <= number < len(self)."""
        begin, end = self.offsets[number:number + 2]
        handle = self._handle()
        before = max(0, begin - TIME_LINES)
        handle.seek(before)
        ahead = bytearray()
        while len(ahead) < begin - before:
            ahead += handle.read1(begin - before - len(ahead))
        found = re.search(rb"ITEM: TIME\n([^\n]+)\n\Z", bytes(ahead))
        text = bytearray()
        while len(text) < end - begin:
            piece = handle.read1(end - begin - len(text))
            if not piece:
                break
            text += piece
        frame = Frame(bytes(text), f"{self.path}, frame {number}")
        frame.columns = [self.rename.get(c, c) for c in frame.columns]
        if found:
            frame.time = float(found.group(1))
        return frame

    def first_seen(self, scan="auto"):
        """Columns of all atoms that occur, sorted by ID, each from the first frame that has it.

        scan: the frames that are searched. "auto": the first, the last and those whose number of
        atoms differs from the one before; "all": every one; else a list of numbers, from the end if
        negative, to which the first is added. A column that a frame lacks is NaN for its atoms."""
        if isinstance(scan, str) and scan not in ("auto", "all"):
            raise DumpError(f"scan is {scan!r}: use 'auto', 'all' or a list of frames")
        count, before, pieces = len(self), None, []
        known = np.zeros(0, dtype=int)
        numbers = range(count) if isinstance(scan, str) else sorted(
            {0, *(n % count for n in scan if -count <= n < count)})
        for n in tqdm(numbers, desc="atom IDs", disable=None, leave=False, delay=2):
            frame = self.frame(n)
            if scan != "auto" or n == count - 1 or frame.natoms != before:
                table = frame.table()
                if "id" not in table:
                    raise DumpError(f"{frame.where}: no column 'id': add it to `dump custom`")
                new = ~np.isin(table["id"], known)
                if new.any():
                    known = np.union1d(known, table["id"].astype(int))
                    pieces.append({c: v[new] for c, v in table.items()})
            before = frame.natoms
        found = {}
        for c in dict.fromkeys(c for piece in pieces for c in piece):
            found[c] = np.concatenate([piece.get(c, np.full(len(piece["id"]), np.nan))
                                       for piece in pieces])
        found["id"] = found.get("id", np.zeros(0)).astype(int)
        order = np.argsort(found["id"], kind="stable")
        return {c: v[order] for c, v in found.items()}


def positions_of(table, box, tilt, where=""):
    """Cartesian coordinates (n, 3), um, from whichever coordinate columns are in `table`."""
    for names in COORDINATES:
        if all(c in table for c in names):
            x = np.stack([table[c] for c in names], axis=1)
            if names[0].startswith("xs"):
                cell = np.diag(box[:, 1] - box[:, 0])
                cell[1, 0], cell[2, 0], cell[2, 1] = tilt
                x = x @ cell + box[:, 0]
            return x
    raise DumpError(f"{where}: no coordinates among the columns {' '.join(table)}: add x y z to "
                    "`dump custom`")


def fill_timestep(ts, table, slot, box, tilt, periodic, where):
    """Copy columns `table` (rows, n) into the timestep; row k goes to slot[k].

    ts.data gets every column and `xyz` (n_atoms, 3), um, double; `box` (3, 2), `tilt` (3,), um;
    `periodic` (3,) bool.
    """
    x = positions_of(table, box, tilt, where)
    for name in set(ts.data) - {"dt", "time_offset"}:
        del ts.data[name]
    for name, values in table.items():
        column = np.full(ts.n_atoms, None if values.dtype == object else np.nan,
                         dtype=object if values.dtype == object else float)
        column[slot] = values
        ts.data[name] = column
    xyz = np.full((ts.n_atoms, 3), np.nan)
    xyz[slot] = x
    ts.data.update(xyz=xyz, box=box, tilt=tilt, periodic=periodic)
    ts.positions = xyz
    for what, names in (("velocities", ("vx", "vy", "vz")), ("forces", ("fx", "fy", "fz"))):
        there = all(c in table for c in names)
        setattr(ts, "has_" + what, there)
        if there:
            setattr(ts, what, np.stack([ts.data[c] for c in names], axis=1))
    cell = np.diag(box[:, 1] - box[:, 0])
    cell[1, 0], cell[2, 0], cell[2, 1] = tilt
    ts.dimensions = triclinic_box(*cell)


class DCMDumpReader(ReaderBase):
    """MDAnalysis reader for text dumps: format='DCMDUMP'.

    ids: IDs of the atoms, one per slot (`lammps_dcm.load` passes those of data file and dump);
    by default the slot is id - 1. dt: length of a LAMMPS step, s. rename: as DumpFile. labels: dict
    of number -> label of an atom type, if the data file has labels. Positions stay where the dump
    has them, the box need not begin at zero.
    """

    format = "DCMDUMP"
    units = {"time": None, "length": None, "velocity": None, "force": None}

    @store_init_arguments
    def __init__(self, filename, ids=None, dt=1.0, n_atoms=None, rename=None, labels=None,
                 **kwargs):
        super().__init__(filename, dt=dt, **kwargs)
        self.labels = labels or {}
        self.dump = DumpFile(self.filename, rename)
        self.step_length = float(dt)
        if ids is None:
            ids = np.arange(1, max(self.dump.first_seen()["id"].max(), n_atoms or 0) + 1)
        self.ids = np.asarray(ids, dtype=int)
        self.n_atoms = len(self.ids)
        self._slots = slot_lookup(self.ids)
        self.ts = self._Timestep(self.n_atoms, **self._ts_kwargs)
        self._read_frame(0)

    @property
    def n_frames(self):
        """Number of complete frames."""
        return len(self.dump)

    def _reopen(self):
        self.ts.frame = -1

    def close(self):
        """Close the dump."""
        if hasattr(self, "dump"):
            self.dump.close()

    def _read_next_timestep(self):
        if self.ts.frame + 1 >= self.n_frames:
            raise EOFError
        return self._read_frame(self.ts.frame + 1)

    def _read_frame(self, number):
        if not 0 <= number < self.n_frames:
            raise IndexError(f"{self.filename}: frame {number} of {self.n_frames}")
        frame = self.dump.frame(number)
        table = frame.table()
        if "id" not in table:
            raise DumpError(f"{frame.where}: no column 'id': add it to `dump custom`")
        ids = table["id"].astype(int)
        known = (ids >= 0) & (ids < len(self._slots))
        known[known] = self._slots[ids[known]] >= 0
        if not known.all():
            raise DumpError(f"{frame.where}: atom ID {ids[~known][0]} has no slot: open with "
                            "lammps_dcm.load(..., scan='all')")
        if len(np.unique(ids)) != len(ids):
            raise DumpError(f"{frame.where}: an atom ID occurs twice")
        fill_timestep(self.ts, table, self._slots[ids], frame.box, frame.tilt, frame.periodic,
                      frame.where)
        self.ts.frame = number
        self.ts.data["step"] = frame.step
        if frame.time is not None:
            self.ts.data["seconds"] = frame.time
        self.ts.time = frame.step * self.step_length if frame.time is None else frame.time
        return self.ts


class DCMDataReader(SingleFrameReaderBase):
    """MDAnalysis reader for the coordinates of a data file of `atom_style dcm`: 'DCMDATA'.

    A data file does not say which boundaries are periodic; all are taken to be.
    """

    format = "DCMDATA"
    units = {"time": None, "length": None, "velocity": None}

    def _read_first_frame(self):
        data = read_data(self.filename)
        table = {c: v for c, v in data.atoms.items() if c != "type"}
        if "Velocities" in data.sections:
            velocities = data.sections["Velocities"]
            velocities = velocities[np.argsort(velocities[:, 0], kind="stable")]
            table.update(zip(("vx", "vy", "vz"), velocities[:, 1:4].T))
        self.n_atoms = len(table["id"])
        self.ts = self._Timestep(self.n_atoms, **self._ts_kwargs)
        fill_timestep(self.ts, table, np.arange(self.n_atoms), data.box, data.tilt,
                      np.ones(3, dtype=bool), self.filename)
        self.ts.frame = 0
        self.ts.dt = 1.0


def merge_atoms(atoms, seen, ids, labels=None):
    """Columns for a topology with one row per id, from the data file where it has the atom, else
    from the dump; what neither knows is 0 (type "0").

    atoms: columns of a data file, or None; seen: DumpFile.first_seen(). Returns a dict of
    ATOM_COLUMNS.
    """
    merged = {c: np.zeros(len(ids), dtype=float if c in ("radius", "x", "y", "z", "volume0")
                          else int) for c in ATOM_COLUMNS}
    merged["id"], merged["type"] = np.asarray(ids), np.full(len(ids), "0", dtype=object)
    slots, missing = slot_lookup(ids), np.ones(len(ids), dtype=bool)
    if atoms is not None:
        at = slots[atoms["id"]]
        missing[at] = False
        for c in ATOM_COLUMNS:
            merged[c][at] = atoms[c]
    at = slots[seen["id"]]
    new = missing[at]
    for c in set(ATOM_COLUMNS[1:]) & set(seen):
        values = seen[c][new]
        merged[c][at[new]] = type_names(values, labels or {}) if c == "type" else \
            np.nan_to_num(values.astype(float))
    return merged
