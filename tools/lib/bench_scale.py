"""tools/bench scale: messages, bytes and memory per rank at constant work per rank.

Standard library only; expects the environment that tools/bench sets (DCM_LMP, LAMMPS_PLUGIN_PATH).
"""

import argparse
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KINDS = ["point-to-point", "allreduce", "allgather", "alltoall", "others"]
RADIUS = 5.0  # of the cells, um
SPACING = 1.96 * RADIUS  # neighbors touch from the start

DECK = """\
units           lj
atom_style      dcm
newton          on
special_bonds   lj/coul 1 1 1
boundary        p p p
processors      {px} {py} {pz}
region          box block 0 {lx} 0 {ly} 0 {lz}
create_box      3 box bond/types 1 dihedral/types 1
mass            * 1.0
create_cells    table cells.txt mesh icosphere {level} rotate 3 rest 0.95 &
                dcm hepatoblast 1 2 3 1 1
fix             cell all dcm/cell types bile_duct.dcm hepatoblast hepatoblast hepatoblast
bond_style      dcm/cortex
bond_coeff      1 hepatoblast
dihedral_style  dcm/bend
dihedral_coeff  1 hepatoblast
pair_style      dcm/contact
pair_coeff      * *
neighbor        0.6 multi
fix             volume all dcm/volume
fix             move all dcm/motion scheme {scheme}
timestep        {dt}
thermo_style    custom step f_move[3] f_move[8]
neigh_modify    {rebuild}
thermo          {steps}
run             {steps}
"""
NEVER, EVERY = "delay 0 every 1 check yes", "delay 0 every 1 check no"    # skin: no need in so few


def split(ranks):
    """Ranks in x, y and z: as near to a cube as their number allows."""
    best = (ranks, 1, 1)
    for z in range(1, ranks + 1):
        for y in range(z, ranks + 1):
            if ranks % (y * z) == 0 and ranks // (y * z) >= y:
                best = min(best, (ranks // (y * z), y, z), key=lambda n: n[0] - n[2])
    return best


class Run:
    """One run of lmp: what each rank sent and holds (means over ranks), and the last thermo row."""

    def __init__(self, folder, grid, edge, options, scheme, steps, rebuild):
        ranks = math.prod(grid)
        sides = [n * edge * SPACING for n in grid]
        px, py, pz = grid
        (folder / "in.scale").write_text(DECK.format(
            px=px, py=py, pz=pz, lx=sides[0], ly=sides[1], lz=sides[2], level=options.level,
            scheme=scheme, dt=options.dt, steps=steps, rebuild=rebuild))
        cells = [[(i + 0.5) * SPACING for i in (x, y, z)] for x in range(px * edge)
                 for y in range(py * edge) for z in range(pz * edge)]
        (folder / "cells.txt").write_text("".join(
            f"hepatoblast dcm {x} {y} {z} {RADIUS}\n" for x, y, z in cells))
        command = ["mpirun", "-np", str(ranks), "env",
                   f"LD_PRELOAD={folder / 'count_messages.so'}", f"DCM_COUNTS={folder / 'counts'}",
                   os.environ["DCM_LMP"], "-in", "in.scale", "-screen", "none", "-nocite"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        log = (folder / "log.lammps").read_text()
        if done.returncode:
            sys.exit(f"lmp failed on {ranks} ranks:\n{log[-2000:]}{done.stdout}{done.stderr}")
        rows = [list(map(int, (folder / f"counts.{p}").read_text().split())) for p in range(ranks)]
        mean = [sum(column) / ranks for column in zip(*rows)]
        n = 2 * len(KINDS)
        self.messages, self.bytes = mean[0:n:2], mean[1:n:2]
        last = log[:log.index("Loop time")].rstrip().splitlines()[-1].split()
        self.iterations, self.nodes = float(last[1]), float(last[2]) / ranks
        self.resident = (mean[n + 1] - mean[n]) / self.nodes / 1024
        memory = re.findall(r"memory allocation .* = (\S+) \| (\S+) \| (\S+) Mbytes", log)
        self.seconds = float(re.search(r"Loop time of (\S+)", log)[1])
        self.lammps = float(memory[-1][1]) * 1024 / self.nodes


def line(ranks, a, b, steps, what):
    """Differences between two runs, per step (or per rebuild)."""
    messages = [(q - p) / steps for p, q in zip(a.messages, b.messages)]
    size = [(q - p) / steps for p, q in zip(a.bytes, b.bytes)]
    fields = "".join(f"{m:8.1f} {s:9.0f}" for m, s in zip(messages, size))
    print(f"{ranks:5d} {what:8s} {fields} {sum(size):10.0f}", flush=True)
    return sum(size)


def main():
    parser = argparse.ArgumentParser(
        prog="tools/bench scale",
        description="Messages, bytes and memory per rank at constant work per rank.")
    parser.add_argument("--ranks", default="1,2,4,8", help="default 1,2,4,8; may be oversubscribed")
    parser.add_argument("--edge", type=int, default=3,
                        help="a rank has EDGE^3 cells (default 3: 27)")
    parser.add_argument("--level", type=int, default=1, help="of icosphere (default 1: 42 nodes)")
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--dt", type=float, default=0.5, help="time step, s (default 0.5)")
    parser.add_argument("--schemes", default="explicit,implicit")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "bile_duct.dcm").write_bytes((ROOT / "potentials/bile_duct.dcm").read_bytes())
        subprocess.run(["mpicc", "-O1", "-shared", "-fPIC", "-o", folder / "count_messages.so",
                        ROOT / "tools/lib/count_messages.c"], check=True)
        heads = "".join(f"{kind:>18s}" for kind in KINDS)
        for scheme in options.schemes.split(","):
            nodes = 10 * 4**options.level + 2
            print(f"\nscheme {scheme}, {options.edge**3} cells of {nodes} nodes a rank: "
                  f"messages and bytes per rank\nranks {'':8s} {heads}  all bytes")
            notes, total = [], {}
            for ranks in map(int, options.ranks.split(",")):
                grid, n = split(ranks), options.steps
                arguments = (folder, grid, options.edge, options, scheme)
                short = Run(*arguments, n, NEVER)
                long = Run(*arguments, 3 * n, NEVER)
                often = Run(*arguments, 3 * n, EVERY)
                total[ranks] = line(ranks, short, long, 2 * n, "step")
                line(ranks, long, often, 3 * n, "rebuild")
                notes.append(f"{ranks:5d} {long.iterations:11.1f} {long.lammps:14.2f} "
                             f"{long.resident:14.2f} "
                             f"{1e6 * (long.seconds - short.seconds) / (2 * n * long.nodes):22.2f}")
            print("ranks  iterations  KiB a node: LAMMPS      resident    us a node-step (time)")
            print("\n".join(notes))
    print(f"bytes_per_step: {max(total.values()):.0f}")


if __name__ == "__main__":
    main()
