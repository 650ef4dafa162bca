"""What is run and what is read: one class per scene, made of a shipped example.

A scene reads values: name -> cell or strain -> list of numbers (um, nN, s, kPa). Runs are compared
cell by cell; `Quantity` says in which unit and relative to what.
"""
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import decks
from .decks import EXAMPLES, MANY, put, swap, until

FAILED = re.compile(r"^ERROR.*?: (.*)", re.M)


@dataclass(frozen=True)
class Quantity:
    """name: of the table; of: of the values; unit: its own; scale: name of the value that errors
    are relative to, empty for the root mean square of the quantity itself; head: the error that
    the picture shows is the largest of those with head."""

    name: str
    of: str
    unit: str
    scale: str = ""
    head: bool = True


class Scene:
    """Defaults of all settings, `write` for a run's folder and `read` of what it left.

    about: a sentence for the table; hours: of biology in a run, None where there is no such time;
    radius: of the cells, um; number of deformable cells, seconds of a run in its own time and
    speed, CPU seconds per node and step: rough, for the time left."""

    name, about, hours, radius = "", "", None, 6.0
    number, seconds, speed = 1, 2000.0, 1e-6
    defaults, quantities = {}, ()
    common = dict(level="2", seed="1", step="auto 0.02", longest="60", tolerance="1e-3",
                  law="foundation", h0="", points="", facing="", layer="0.1", skin="1.0")

    def settings(self, changes):
        """Defaults with `changes`; names a setting that there is not."""
        known = self.common | self.defaults
        for name in changes:
            if name not in known:
                raise ValueError(f"scene {self.name} has no setting {name}; it has "
                                 + " ".join(sorted(known)))
        return known | changes

    def write(self, folder, settings):
        """Write the deck `in.run` and what it needs; returns options of the command line."""
        raise NotImplementedError

    def read(self, folder):
        """Values of a run that has ended, see above."""
        raise NotImplementedError

    def move(self, s):
        return decks.motion(s["step"], s["tolerance"], s["longest"])

    def weight(self, settings):
        """About how many seconds a run takes: for the time left."""
        s = self.settings(settings)
        value = float(s["step"].split()[1])
        step = 25.0 * (value / 0.02)**0.3 if decks.chosen(s["step"]) else value
        nodes = self.number * (10 * 4**int(s["level"]) + 2)
        return 0.15 + self.speed * nodes * self.seconds / step


def cell_values(rows, keys, start=None):
    """pressure, area and, with `start`, way of cells: dict key -> list, of a frame's columns."""
    where = np.array([rows[c] for c in "xyz"]).T
    found = dict(
        pressure={k: [float(p)] for k, p in zip(keys, rows["pressure"])},
        area={k: [float(a)] for k, a in zip(keys, rows["area"])},
    )
    if start is not None:
        found["way"] = {k: [float(v) for v in w - start[k]] for k, w in zip(keys, where)}
    return found


def diameter(volumes):
    """Mean diameter of round cells of these volumes, as a value."""
    return {"": [float(np.mean(np.cbrt(6.0 * np.asarray(volumes) / np.pi)))]}


CELL_DUMP = """
compute         map all dcm/cell molecule volume pressure contact_area
dump            map centers custom {many} cells.dump id x y z c_map[*]
dump_modify     map every/time {every} time yes sort id format float %.12g &
                colname c_map[1] mol colname c_map[2] volume colname c_map[3] pressure &
                colname c_map[4] area
"""


class BileDuct(Scene):
    name = "bile_duct"
    about = "14 deformable cells and 66 spheres come to rest around a vein, 1500 s"
    hours = 1500.0 / 3600.0
    number, seconds, speed = 14, 1500.0, 2.4e-6
    times = (300.0, 1500.0)
    quantities = tuple(
        q for t in ("300 s", "1500 s") for q in (
            Quantity(f"pressure, {t}", f"pressure {t}", "kPa"),
            Quantity(f"contact area, {t}", f"area {t}", "um^2"),
            Quantity(f"center / diameter, {t}", f"way {t}", "um", "diameter"),
            Quantity(f"center / way made, {t}", f"way {t}", "um", "", t == "1500 s"),
        ))

    def write(self, folder, settings):
        s = settings
        scene = decks.example("bile_duct/scene.bile_duct")
        scene = put(scene, "rotate 1 ", f"rotate {s['seed']} ")
        scene = swap(scene, "neighbor 1.0", f"neighbor        {s['skin']} multi")
        scene = swap(scene, "pair_style", decks.pair(s))
        scene = swap(scene, "pair_coeff", f"pair_coeff      * * {layer(s)}")
        scene = swap(scene, "timestep", decks.timestep(s["step"]))
        (folder / "scene.bile_duct").write_text(scene)
        text = until(decks.example("bile_duct/in.bile_duct"), "compute cell cells")
        text = swap(text, "fix_modify move stop", f"fix_modify move stop {self.times[-1]}")
        text += put(CELL_DUMP.format(many=MANY, every=300), "map centers", "map dcm")
        (folder / "in.run").write_text(text + f"thermo 100\nrun {MANY}\n")
        shutil.copy(EXAMPLES / "bile_duct/cells.quick.txt", folder)
        return ["-var", "level", s["level"], "-var", "motion", self.move(s)]

    def read(self, folder):
        frames = decks.frames(folder / "cells.dump")
        first = frames[0][1]
        keys = [f"{m:.0f}" for m in first["mol"]]
        start = dict(zip(keys, np.array([first[c] for c in "xyz"]).T))
        found = {"diameter": diameter(first["volume"])}
        for time, rows in frames:
            # with steps of fixed length the frame is the first step that reaches the time
            near = [t for t in self.times if 0.0 <= time - t < 1e-6]
            for t in near:
                for name, value in cell_values(rows, keys, start).items():
                    found[f"{name} {t:g} s"] = value
        return found


def layer(s):
    """Words of pair_coeff for the thickness of the elastic layer, of law foundation only."""
    return f"layer {s['layer']}" if s["law"] == "foundation" else ""


class Spheroid(Scene):
    name = "spheroid"
    about = "one cell becomes four in 2.4 h (cycle of 1 h)"
    hours, radius = 2.4, 4.76
    number, seconds = 1.6, 8640.0
    defaults = dict(division="1e-3")
    times = (6480.0, 8640.0)    # two cells, 47 min after the division; four, some minutes after
    quantities = (Quantity("times of divisions / cycle", "division", "s", "cycle"), *(
        q for t in ("1.8 h", "2.4 h") for q in (
            Quantity(f"pressure, {t}", f"pressure {t}", "kPa"),
            Quantity(f"volume, {t}", f"volume {t}", "um^3"),
            Quantity(f"contact area, {t}", f"area {t}", "um^2"),
            Quantity(f"center / diameter, {t}", f"place {t}", "um", "diameter"),
            Quantity(f"center / distance from the middle, {t}", f"place {t}", "um", "", False),
        )))

    def write(self, folder, settings):
        s = settings
        text = until(decks.example("spheroid/in.spheroid"), "write_dump")
        text = put(text, "rotate ${seed}", f"rotate {s['seed']}")
        text = swap(text, "variable seed", "variable        seed index 1")
        text = swap(text, "neighbor", f"neighbor        {s['skin']} multi")
        text = swap(text, "pair_style", decks.pair(s))
        text = swap(text, "pair_coeff", f"pair_coeff      * * {layer(s)}")
        text = swap(text, "timestep", decks.timestep(s["step"]))
        text = swap(text, "fix division", "fix division all dcm/division seed ${seed} "
                    f"tolerance {s['division']} log division.log")
        text = re.sub(r"^fix\s+history.*$", "", text, flags=re.M)
        text = swap(text, "run", CELL_DUMP.format(many=MANY, every=2160)
                    + f"run {MANY}")
        (folder / "in.run").write_text(text)
        return ["-var", "level", s["level"], "-var", "motion", self.move(s), "-var", "movie", "no",
                "-var", "hours", f"{self.hours}"]

    def read(self, folder):
        names, times = {1: "0"}, {}
        for line in (folder / "division.log").read_text().splitlines():
            if line.startswith("#"):
                continue
            words = line.split()
            mother, one, two = map(int, words[2:5])
            names[one], names[two] = names[mother] + "a", names[mother] + "b"
            times[names[mother]] = [float(words[1])]
        found = {"division": times, "cycle": {"": [3600.0]}}
        for time, rows in decks.frames(folder / "cells.dump"):
            for t in (t for t in self.times if 0.0 <= time - t < 1e-6):
                keys = [names[int(m)] for m in rows["mol"]]
                middle = np.mean([rows[c] for c in "xyz"], axis=1)
                values = cell_values(rows, keys, dict.fromkeys(keys, middle))
                values["place"] = values.pop("way")
                values["volume"] = {k: [float(v)] for k, v in zip(keys, rows["volume"])}
                found |= {f"{name} {t / 3600.0:g} h": v for name, v in values.items()}
                found["diameter"] = diameter(rows["volume"])
        return found


class Compress(Scene):
    name = "compress"
    about = "one cell between plates, pushed together by 0.5 um three times, 400 s each"
    seconds = 1200.0
    defaults = dict(step="implicit 4", tolerance="1e-4", skin="0.6", seed="3", longest="60")
    quantities = tuple(
        Quantity(f"{name}, {when}", f"{of} {when}", unit)
        for when in ("after 40 s", "at rest")
        for name, of, unit in (("plate force", "force", "nN"), ("contact area", "area", "um^2"),
                               ("pressure", "pressure", "kPa")))

    def write(self, folder, settings):
        s = settings
        text = until(decks.example("contact/in.plates"), "thermo_style")
        text = put(text, "rotate 3", f"rotate {s['seed']}")
        text = swap(text, "neighbor", f"neighbor        {s['skin']} multi")
        text = swap(text, "pair_style", decks.pair(s))
        text = swap(text, "fix move", f"fix move cell dcm/motion {self.move(s)} stop 1e9")
        text += decks.timestep(s["step"]) + f"""
thermo_style    custom step time v_force v_area f_volume[1] f_move[4]
thermo_modify   norm no
thermo          {MANY}
label           again
variable        k loop 3
displace_atoms  upper move 0 0 -$(0.5*v_by) units box
displace_atoms  lower move 0 0  $(0.5*v_by) units box
fix_modify      move stop $(400*(v_k-1)+40)
run             {MANY} post no
print           "soon $(v_k) $(v_force:%.10g) $(v_area:%.10g) $(f_volume[1]:%.10g)"
fix_modify      move stop $(400*v_k)
run             {MANY} post no
print           "rest $(v_k) $(v_force:%.10g) $(v_area:%.10g) $(f_volume[1]:%.10g)"
next            k
jump            SELF again
"""
        (folder / "in.run").write_text(text)
        return ["-var", "level", s["level"], "-var", "law", s["law"], "-var", "layer", s["layer"],
                "-var", "image", "no"]

    def read(self, folder):
        text, found = (folder / "log.lammps").read_text(), {}
        for word, when in (("soon", "after 40 s"), ("rest", "at rest")):
            rows = decks.marked(text, word)
            for k, name in enumerate(("force", "area", "pressure")):
                found[f"{name} {when}"] = {key: [row[k]] for key, row in rows.items()}
        return found


class Doublet(Scene):
    name = "doublet"
    about = "two cells adhere for 2000 s and are pulled apart"
    number, seconds = 2, 4000.0
    defaults = dict(step="implicit 1", skin="0.3", seed="3", other="11", press="0.0", pull="yes",
                    friction="5")
    quantities = (
        Quantity("contact radius, 200 s", "radius soon", "um"),
        Quantity("contact radius at rest", "radius", "um"),
        Quantity("distance at rest", "distance", "um"),
        Quantity("load at separation", "load", "nN"),
        Quantity("pull-off force", "pull_off", "nN"),
        Quantity("work of adhesion", "adhesion", "nN/um"),
    )

    def write(self, folder, settings):
        s = settings
        text = decks.example("doublet/in.doublet")
        text = swap(text, "neighbor", f"neighbor        {s['skin']} multi")
        text = re.sub(r'^if "\$\(is_defined\(variable,h0\)\)".*$', lambda _: decks.pair(s), text,
                      flags=re.M)
        text = swap(text, "pair_coeff", "pair_coeff * * friction_normal ${friction} "
                    f"friction_tangential ${{friction}} {layer(s)}")
        text = swap(text, "fix move", f"fix move all dcm/motion {self.move(s)} stop 200")
        text = swap(text, "timestep", decks.timestep(s["step"]))
        text = swap(text, "thermo 250", f"thermo {MANY}")
        text = swap(text, "run $(round(v_settle/v_dt))", f"""run {MANY} post no
print "soon radius $(v_radius:%.10g)"
fix_modify move stop ${{settle}}
run {MANY} post no""")
        pull = text.index("# 2. pull")
        first, second = text[:pull] + """
print "rest radius $(v_radius:%.10g)"
print "rest distance $(v_distance:%.10g)"
fix_modify move stop 1e9
""", text[pull:]
        (folder / "in.run").write_text(first + (second if s["pull"] == "yes" else ""))
        dt = [] if decks.chosen(s["step"]) else ["-var", "dt", s["step"].split()[1]]
        return ["-var", "level", s["level"], "-var", "seed", s["seed"], "-var", "other", s["other"],
                "-var", "press", s["press"], "-var", "friction", s["friction"],
                "-var", "image", "no", *dt]

    def read(self, folder):
        text = (folder / "log.lammps").read_text()
        found = {f"{k} soon": {"": v} for k, v in decks.marked(text, "soon").items()}
        found |= {k: {"": v} for k, v in decks.marked(text, "rest").items()}
        number = r"([-+\d.e]+)"
        for pattern, names in (
            (rf"load at separation: {number} nN, {number}", ("pull_off", "load")),
            (rf"area at rest: +{number}", ("adhesion",)),
        ):
            match = re.search(pattern, text)
            if match:
                found |= {n: {"": [float(v)]} for n, v in zip(names, match.groups())}
        return found


class Lumen(Scene):
    name = "lumen"
    about = "a lumen opens between four cells and holds, 40 min"
    hours = 2400.0 / 3600.0
    number, seconds, speed = 4, 2400.0, 4e-6
    times = (1500, 1800, 2100, 2400)
    defaults = dict(longest="20", osmosis="", polarity="", fluid="", marks="flood", number="500",
                    substeps="1")
    quantities = (
        Quantity("section, 25 to 40 min", "section", "um^2"),
        Quantity("pressure of the cells", "pressure", "kPa"),
    )

    def write(self, folder, settings):
        s = settings
        text = until(decks.example("lumen/in.lumen"), "compute atoms all")
        text = put(text, "icosphere 2 rotate ${seed}",
                   f"icosphere {s['level']} rotate {s['seed']}")
        text = swap(text, "neighbor", f"neighbor        {s['skin']} multi")
        text = swap(text, "pair_style", decks.pair(s))
        text = swap(text, "pair_coeff", f"pair_coeff      * * {layer(s)}")
        text = swap(text, "timestep", decks.timestep(s["step"]))
        text = swap(text, "run", f"run {MANY} post no")
        text = swap(text, "variable excess", "variable        excess equal v_P")
        every = f" every {s['polarity']}" if s["polarity"] else ""
        text = re.sub(r"^(fix\s+polarity.*)$", rf"\1{every}", text, flags=re.M)
        more = f" every {s['osmosis']}" if s["osmosis"] else ""
        more += f" longest {s['fluid']}" if s["fluid"] else ""
        text = re.sub(r"^(fix\s+osmosis.*)$", rf"\1{more}", text, flags=re.M)
        if s["marks"] == "tracer":
            text = put(text, "create_box      5", "create_box      6")
            text = put(text, "hepatoblast_cbm hepatoblast_cbm",
                       "hepatoblast_cbm hepatoblast_cbm NULL")
            text = put(text, "marks flood", "marks tracer")
            text = re.sub(r"^(fix\s+osmosis.*)$", "fix tracer dcm dcm/tracer type 6 number "
                          rf"{s['number']} D 0.04 seed {s['seed']} substeps {s['substeps']} "
                          r"slab z -3 3\n\1", text, flags=re.M)
        text += "thermo_style custom step time c_pressure c_lumen[4]\n"
        for time in self.times:
            text += (f"fix_modify move stop {time}\nrun {MANY} post no\n"
                     f'print "at {time} $(c_lumen[4]:%.10g) $(c_pressure:%.10g)"\n')
        (folder / "in.run").write_text(text)
        shutil.copy(EXAMPLES / "lumen/cells.txt", folder)
        return ["-var", "motion", self.move(s), "-var", "movie", "no"]

    def read(self, folder):
        rows = decks.marked((folder / "log.lammps").read_text(), "at")
        return dict(section={k: [v[0]] for k, v in rows.items()},
                    pressure={k: [v[1]] for k, v in rows.items()})


class Migration(Scene):
    name = "migration"
    about = "a cell crawls through between two others, 2000 s, forces held for 20 s"
    hours = 2000.0 / 3600.0
    number = 3
    defaults = dict(step="explicit 1", law="dmt", skin="0.6", seed="3", longest="20")
    quantities = (
        Quantity("mean squared displacement", "msd", "um^2"),
        Quantity("way of the crawler", "way", "um"),
        Quantity("its pressure", "pressure", "kPa"),
    )

    def write(self, folder, settings):
        s = settings
        text = until(decks.example("migration/in.migration"), "compute crawl")
        text = put(text, "rotate 3", f"rotate {s['seed']}")
        text = swap(text, "neighbor", f"neighbor        {s['skin']} multi")
        text = swap(text, "pair_style", decks.pair(s))
        text = swap(text, "pair_coeff", "pair_coeff * * friction_normal ${friction} "
                    f"friction_tangential ${{friction}} {layer(s)}")
        text = swap(text, "fix move", f"fix move all dcm/motion {self.move(s)} stop 2000")
        text = re.sub(r"^(fix\s+(?:wander|crawl).*)$", r"\1 interval 20", text, flags=re.M)
        text += decks.timestep(s["step"]) + CELL_DUMP.format(many=MANY, every=100)
        (folder / "in.run").write_text(text + f"thermo {MANY}\nrun {MANY}\n")
        return ["-var", "level", s["level"]]

    def read(self, folder):
        frames = decks.frames(folder / "cells.dump")
        path = np.array([[rows[c] for c in "xyz"] for _, rows in frames]).transpose(0, 2, 1)
        lags = (1, 2, 5, 10)    # of 100 s
        msd = {f"{lag}00": [float(np.mean(np.sum((path[lag:] - path[:-lag])**2, axis=2)))]
               for lag in lags}
        crawler = path[::5, -1] - path[0, -1]
        return dict(msd=msd, way={str(k): list(map(float, w)) for k, w in enumerate(crawler) if k},
                    pressure={str(k): [float(rows["pressure"][-1])]
                              for k, (_, rows) in enumerate(frames) if k and k % 5 == 0})


class Border(Scene):
    name = "border"
    about = "a cell grows in a layer of spheres, rings of deformable cells around it, 75 min"
    hours = 1.25
    number, seconds, speed = 50, 4500.0, 1.5e-5
    defaults = dict(border="1")
    quantities = (
        Quantity("pressure of the middle and its neighbors", "pressure", "kPa"),
        Quantity("their contact area", "area", "um^2"),
        Quantity("center / diameter", "place", "um", "diameter"),
    )

    def write(self, folder, settings):
        s = settings
        text = until(decks.example("resolution/in.resolution"), "write_data")
        text = swap(text, "timestep", decks.timestep(s["step"]))
        (folder / "in.run").write_text(text)
        shutil.copy(EXAMPLES / "resolution/cells.txt", folder)
        return ["-var", "border", s["border"], "-var", "level", s["level"], "-var", "seed",
                s["seed"], "-var", "motion", self.move(s), "-var", "hours", f"{self.hours}",
                "-var", "image", "no"]

    def read(self, folder):
        _, rows = decks.frames(folder / "resolution.table")[-1]
        near = rows["cell"] <= 7
        rows = {name: column[near] for name, column in rows.items()}
        rows["area"] = rows["contact_area"]
        keys = [f"{c:.0f}" for c in rows["cell"]]
        found = cell_values(rows, keys, dict.fromkeys(keys, np.zeros(3)))
        found["place"] = found.pop("way")
        return found | {"diameter": diameter(rows["volume"])}


SCENES = {scene.name: scene for scene in
          (Doublet(), Compress(), Spheroid(), BileDuct(), Lumen(), Migration(), Border())}


def failure(folder):
    """Message of a run that stopped, one line."""
    for name in ("log.lammps", "out"):
        path = Path(folder) / name
        if path.exists():
            match = FAILED.search(path.read_text(errors="replace"))
            if match:
                return match.group(1)
    return "stopped without a message"
