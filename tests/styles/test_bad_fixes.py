"""Bad arguments of fixes and computes: one error that names style, value and remedy."""

import re

import pytest

from support.bad_decks import fails, whole

VOLUME = "fix volume all dcm/volume {map} "
MOTION = "fix motion all dcm/motion {map} "
MOTILITY = "fix motility all dcm/motility {map} "
CONFINE = "fix confine all dcm/confine "
FIXES = {
    "K_V negative": (VOLUME + "K_V -1", "Fix dcm/volume: K_V is -1.*positive"),
    "K_V zero": (VOLUME + "K_V 0", "Fix dcm/volume: K_V is 0.*positive"),
    "K_V nan": (VOLUME + "K_V nan", "Fix dcm/volume: K_V is 'nan'.*number"),
    "K_V text": (VOLUME + "K_V soft", "Fix dcm/volume: K_V is 'soft'.*number"),
    "volume form": (VOLUME + "form x", "Fix dcm/volume: form must be gradient or voronoi, not x"),
    "volume keyword": (VOLUME + "x 1", "Fix dcm/volume: unknown keyword x; known"),
    "volume file": ("fix v all dcm/volume none.dcm a a a a", "Fix dcm/volume.*none.dcm.*path"),
    "volume type": ("fix v all dcm/volume bile_duct.dcm a a a a", "Fix dcm/volume.*cell type a"),
    "volume names": ("fix v all dcm/volume bile_duct.dcm", "Fix dcm/volume: expected"),
    "volume modulus": ("fix v all dcm/volume bile_duct.dcm endothelium NULL NULL NULL",
                       "Fix dcm/volume: no value of K_V for cell type endothelium"),
    "volume twice": (VOLUME + "\n" + VOLUME.replace("fix volume", "fix again"),
                     "Fix dcm/volume: fixes .* both act on cell 1"),
    "friction negative": (MOTION + "friction_ecm -1", "Fix dcm/motion.*friction_ecm.*-1"),
    "friction nan": (MOTION + "friction_ecm nan", "Fix dcm/motion: friction_ecm is 'nan'"),
    "friction text": (MOTION + "friction_ecm x", "Fix dcm/motion: friction_ecm is 'x'"),
    "tolerance": (MOTION + "tolerance 0", "Fix dcm/motion: tolerance is 0.*positive"),
    "tolerance large": (MOTION + "tolerance 2", "Fix dcm/motion: tolerance is 2.*below 1"),
    "tolerance text": (MOTION + "tolerance x", "Fix dcm/motion: tolerance is 'x'"),
    "maxiter": (MOTION + "maxiter 1.5", "Fix dcm/motion: maxiter is 1.5.*whole"),
    "maxiter text": (MOTION + "maxiter x", "Fix dcm/motion: maxiter is 'x'"),
    "maxmove": (MOTION + "maxmove -1", "Fix dcm/motion: maxmove is -1.*positive"),
    "maxmove text": (MOTION + "maxmove x", "Fix dcm/motion: maxmove is 'x'"),
    "floor": (MOTION + "floor 2", "Fix dcm/motion: floor is 2, must be 0 to 1"),
    "precondition": (MOTION + "precondition x",
                     "Fix dcm/motion: precondition must be block, jacobi or none, not x"),
    "motion keyword": (MOTION + "x 1", "Fix dcm/motion: unknown keyword x; known"),
    "motion file": ("fix m all dcm/motion none.dcm a a a a", "Fix dcm/motion.*none.dcm.*path"),
    "motion type": ("fix m all dcm/motion bile_duct.dcm a a a a", "Fix dcm/motion.*cell type a"),
    "motion names": ("fix m all dcm/motion", "Fix dcm/motion: expected"),
    "motion NULL": ("fix m all dcm/motion bile_duct.dcm NULL NULL NULL NULL",
                    "Fix dcm/motion: atom type 2 holds nodes.*NULL"),
    "motion twice": (MOTION + "\n" + MOTION.replace("fix motion", "fix again"),
                     "Fix dcm/motion: there are two"),
    "motion and nve": (MOTION + "\nfix nve all nve", "Fix dcm/motion and fix nve.*unfix one"),
    "motility seed": (MOTILITY, "Fix dcm/motility: add 'seed S'"),
    "motility seed text": (MOTILITY + "seed x", "Fix dcm/motility: seed is 'x', expected"),
    "motility seed negative": (MOTILITY + "seed -1",
                               "Fix dcm/motility: seed is -1, must be a whole number"),
    "motility D": (MOTILITY + "seed 1 D -1", "Fix dcm/motility: D is -1"),
    "motility D nan": (MOTILITY + "seed 1 D nan", "Fix dcm/motility: D is 'nan'"),
    "motility D text": (MOTILITY + "seed 1 D x", "Fix dcm/motility: D is 'x'"),
    "motility bias": (MOTILITY + "seed 1 bias 0 0 0 1", "Fix dcm/motility.*bias is zero"),
    "motility bias text": (MOTILITY + "seed 1 bias 0 x 0 1", "Fix dcm/motility: bias is 'x'"),
    "motility bias short": (MOTILITY + "seed 1 bias 0 0", "Fix dcm/motility.*bias needs 4"),
    "motility persistence": (MOTILITY + "seed 1 persistence 0", "persistence is 0.*positive"),
    "motility plane": (MOTILITY + "seed 1 plane w", "Fix dcm/motility: plane must be x, y or z"),
    "motility keyword": (MOTILITY + "seed 1 x 1", "Fix dcm/motility: unknown keyword x; known"),
    "motility names": ("fix m all dcm/motility bile_duct.dcm", "Fix dcm/motility: expected"),
    "confine nothing": (CONFINE, "Fix dcm/confine: give 'pressure"),
    "confine pressure": (CONFINE + "pressure -1 over all", "Fix dcm/confine: pressure is -1"),
    "confine text": (CONFINE + "pressure x over all", "Fix dcm/confine: pressure is 'x'"),
    "confine nan": (CONFINE + "pressure nan over all", "Fix dcm/confine: pressure is 'nan'"),
    "confine over": (CONFINE + "pressure 1", "Fix dcm/confine: pressure needs 'over GROUP'"),
    "confine group": (CONFINE + "pressure 1 over none", "Fix dcm/confine: over: there is no group"),
    "confine axis": (CONFINE + "pressure 1 over all axis w", "Fix dcm/confine: axis must be"),
    "confine center": (CONFINE + "pressure 1 over all center 0 x", "confine: center is 'x'"),
    "confine tau": (CONFINE + "pressure 1 over all tau 0", "Fix dcm/confine: tau is 0.*positive"),
    "confine tau short": (CONFINE + "pressure 1 over all tau 1", "tau is 1, must be at least 10"),
    "confine limit": (CONFINE + "pressure 1 over all limit x", "Fix dcm/confine: limit is 'x'"),
    "confine area": (CONFINE + "pressure 1 over all area -1", "Fix dcm/confine: area is -1"),
    "confine plane": (CONFINE + "plane z x", "Fix dcm/confine: plane force constant is 'x'"),
    "confine plane axis": (CONFINE + "plane w 1", "Fix dcm/confine: plane must be x, y or z"),
    "confine at": (CONFINE + "plane z 1 at x", "Fix dcm/confine: at is 'x'"),
    "confine keyword": (CONFINE + "x 1", "Fix dcm/confine: unknown keyword x; known"),
    "confine short": (CONFINE + "pressure", "Fix dcm/confine: keyword pressure needs a value"),
    "confine twice": (CONFINE + "pressure 1 over all pressure 2", "keyword pressure is .*twice"),
    "tension twice": ("fix t all dcm/tension {map} tension 0.1 tension v_t", "tension is .*twice"),
    "motion keyword twice": (MOTION + "tolerance 1e-4 tolerance 1e-3", "tolerance is there twice"),
    "volume keyword twice": (VOLUME + "K_V 1.0 K_V 2.0", "volume: keyword K_V is there twice"),
    "cell keyword": ("fix c all dcm/cell x", "Fix dcm/cell: unknown keyword x"),
    "cell group": ("group g empty\nfix c g dcm/cell", "Fix dcm/cell must have group all, not g"),
    "cell twice": ("fix c all dcm/cell\nfix d all dcm/cell", "fix dcm/cell already.*exactly one"),
    "compute cell": ("compute c all dcm/cell mass", "Compute dcm/cell: unknown value mass; known"),
    "compute cell none": ("compute c all dcm/cell", "Compute dcm/cell: no values given; known"),
    "compute face": ("compute c all dcm/face mass", "Compute dcm/face: unknown value mass; known"),
    "compute face none": ("compute c all dcm/face", "Compute dcm/face: no values given; known"),
}  # fmt: skip


@pytest.mark.parametrize("case", FIXES)
def test_fix(lmp, scenes, case):
    text, *patterns = FIXES[case]
    scene = scenes.doublet()
    text = text.format(map=scene.map) + "\n"
    drop = {"extra": text}
    for part, style in (("volume", "dcm/volume"), ("motion", "dcm/motion"), ("cell", "dcm/cell")):
        if re.search(style + r"\b", text) and "compute" not in text:
            drop[part] = ""
    fails(lmp, whole(scene, **drop), *patterns)


@pytest.mark.parametrize("users", ["volume", "motion", "contact", "compute", "confine", "motility"])
def test_no_fix_cell(lmp, scenes, users):
    """Each style that needs the bookkeeping asks for it."""
    scene = scenes.doublet()
    none = {"cell": "", "volume": "", "motion": "", "contact": ""}
    part = {
        "volume": {"volume": scene.volume()},
        "motion": {"motion": scene.motion()},
        "contact": {"contact": scene.contact()},
        "compute": {"extra": "compute c all dcm/cell volume\n"},
        "confine": {"extra": "fix c all dcm/confine plane z 1\n"},
        "motility": {"extra": scene.motility()},
    }[users]  # fmt: skip
    fails(lmp, whole(scene, **{**none, **part}), "dcm/", "add 'fix cell all dcm/cell'")
