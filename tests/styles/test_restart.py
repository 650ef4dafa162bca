"""Restart files bit for bit, data files to round-off."""

import numpy as np
import pytest

COLUMNS = "id mol type radius xu yu zu vx vy vz fx fy fz"


def scene_of(scenes, boundary):
    return scenes.hybrid(level=1, boundary=boundary, box=(27.0, 27.0, 14.0), shift=(3.0, 2.0, 0.5))


def fixes(scene):
    return (
        "fix cell all dcm/cell\n"
        + scene.volume()
        + scene.motility(options="D 1e-3 bias 1 0.7 0.3 2.0 persistence 20.0")
        + "fix plane all dcm/confine plane z 2.0\n"
        + scene.motion()
        + "timestep 1.0\n"
    )


@pytest.mark.parametrize("law, boundary", [
    ("dmt", "s s s"), ("dmt", "p p p"), ("maugis branch history", "s s s"),
    ("maugis branch history", "p p p"), ("foundation", "f f f"), ("foundation", "p p p")])
@pytest.mark.parametrize("np_", [1, 2])
def test_restart_is_bit_for_bit(lmp, scenes, np_, boundary, law):
    """100 steps after a restart at step 100 are those of the run that wrote it.

    In a shrink-wrapped box LAMMPS' margin is a share of the box that a run began with, so that bins
    of the neighbor list differ after a restart, and with them, now and then, the order of pairs and
    last digits: with law foundation at step 174 of this scene, for which the box is fixed here.

    The grid of processors is given: LAMMPS would choose it anew for the shrunken box.
    """
    scene = scene_of(scenes, boundary)
    processors = "processors * 1 1\n"
    whole = lmp(
        processors
        + scene.head()
        + scene.cortex()
        + scene.contact(f"law {law}")
        + fixes(scene)
        + scenes.dump(COLUMNS, 25)
        + scenes.thermo(["pe", "press"], 25)
        + "restart 100 r.*\nrun 200\n",
        np=np_,
    )
    rest = lmp(
        processors
        + "read_restart r.100\n"
        + f"pair_coeff * * {scene.map}\nneighbor 0.6 multi\n"  # kept in no restart file
        + fixes(scene)
        + scenes.dump(COLUMNS, 25)
        + scenes.thermo(["pe", "press"], 25)
        + "restart 100 r.*\nrun 100\n",  # lists are rebuilt where a restart is written
        np=np_,
        files={"r.100": whole.path / "r.100"},
    )
    expected, found = whole.dump()[4:], rest.dump()
    assert [frame.step for frame in found] == [100, 125, 150, 175, 200]
    for a, b in zip(expected, found, strict=True):
        for name in COLUMNS.split():
            if name[0] == "f" and a.step == 100:
                continue  # motility acts once a step, not in setup
            different = np.flatnonzero(a[name] != b[name])
            assert not len(different), (
                f"step {a.step}: {name} of {len(different)} atoms differs, by up to "
                f"{np.abs(a[name] - b[name]).max():.3g}; types {set(a['type'][different])}"
            )


def test_run_in_two_parts(lmp, scenes):
    """run 60 twice and run 120: only neighbor lists and the order of sums differ."""
    scene = scene_of(scenes, "s s s")
    deck = scene.head() + scene.cortex() + scene.contact() + fixes(scene)
    deck += scenes.dump(COLUMNS, 120)
    a = lmp(deck + "run 120\n").dump()[-1]
    b = lmp(deck + "run 60\nrun 60\n").dump()[-1]
    assert np.abs(a.x - b.x).max() < 1e-10
    assert np.abs(a.v - b.v).max() < 1e-10


@pytest.mark.parametrize("np_", [1, 2])
def test_data_file_round_trip(lmp, scenes, np_):
    """write_data nofix and the rest state beside it give the same forces to 1e-12."""
    scene = scene_of(scenes, "p p p")
    laws = scene.cortex() + scene.contact("h0 0.25 range 2.0")
    written = lmp(
        scene.head()
        + laws
        + fixes(scene)
        + "run 100\n"
        + "write_data out.data nofix nocoeff\nfix_modify cell rest/write out.rest\n"
        + "unfix motility\nunfix plane\n"
        + scenes.dump(COLUMNS, 1)
        + scenes.thermo(["pe", "ebond", "edihed", "p=f_volume[1]"])
        + "run 0\n",
        np=np_,
    )
    read = lmp(
        "units lj\natom_style dcm\nnewton on\nboundary p p p\n"
        "read_data out.data extra/bond/per/atom 8 extra/dihedral/per/atom 8\n"
        + laws
        + "fix cell all dcm/cell\nfix_modify cell rest/read out.rest\n"
        + scene.volume()
        + scene.motion()
        + scenes.dump(COLUMNS, 1)
        + scenes.thermo(["pe", "ebond", "edihed", "p=f_volume[1]"])
        + "run 0\n",
        np=np_,
        files={name: written.path / name for name in ("out.data", "out.rest")},
    )
    a, b = written.dump()[0], read.dump()[0]
    scale = np.abs(a.f).max()
    assert scale > 0.01
    assert np.abs(a.x - b.x).max() < 1e-14 * 30.0
    assert np.abs(a.f - b.f).max() < 1e-12 * scale
    for key, value in written.thermo[-1].items():
        if key != "Step":
            assert read.thermo[-1][key] == pytest.approx(value, rel=1e-11), key


def test_data_file_alone_takes_the_shape_as_rest_state(lmp, scenes):
    """Without the rest state, edges and hinges are at rest in the shape that was read."""
    scene = scenes.single_cell(level=1, boundary="p p p")
    written = lmp(scene.head() + "write_data out.data nofix nocoeff\n")
    read = lmp(
        "units lj\natom_style dcm\nnewton on\nboundary p p p\nread_data out.data\n"
        + scene.cortex(bend="rest mesh")
        + "comm_modify cutoff 8\nfix cell all dcm/cell\n"
        + scenes.thermo(["ebond", "edihed"])
        + "run 0\n",
        files={"out.data": written.path / "out.data"},
    )
    row = read.thermo[0]
    assert abs(row["E_bond"]) < 1e-20 and abs(row["E_dihed"]) < 1e-12


# --- what the neighbor list is laid out for -------------------------------------------------------


def spheres_that_grow(scene, scenes, contact="growth 1.3"):
    return (
        f"pair_style dcm/contact {contact}\npair_coeff * * {scene.map}\nneighbor 0.6 multi\n"
        + fixes(scene)
        + "group balls type 4\n"
        + scenes.dump(COLUMNS, 25)
    )


GROW = "set group balls diameter 11\nrun {} pre no\n"  # in a run that was set up for 10


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_after_growth_is_bit_for_bit(lmp, scenes, np_):
    """The list stays laid out for what the first run promised, also after a restart."""
    scene = scene_of(scenes, "p p p")
    processors = "processors * 1 1\n"
    whole = lmp(
        processors
        + scene.head()
        + scene.cortex()
        + spheres_that_grow(scene, scenes)
        + "restart 25 r.*\nrun 25\n"
        + GROW.format(75),
        np=np_,
    )
    rest = lmp(
        processors
        + "read_restart r.50\n"
        + spheres_that_grow(scene, scenes)
        + "restart 25 r.*\nrun 50\n",
        np=np_,
        files={"r.50": whole.path / "r.50"},
    )
    assert "laid out for" not in rest.log and "ghost cutoff set" not in rest.log
    expected, found = whole.dump()[-3:], rest.dump()
    assert [frame.step for frame in found] == [50, 75, 100]
    assert found[-1]["radius"].max() == 5.5
    for a, b in zip(expected, found, strict=True):
        for name in COLUMNS.split():
            if name[0] == "f" and a.step == 50:
                continue  # motility acts once a step, not in setup
            assert np.array_equal(a[name], b[name]), (a.step, name)


@pytest.mark.parametrize("diameter", [10.6, 11.1])
def test_one_that_outgrows_the_promise(lmp, scenes, diameter):
    """The list holds pairs up to the sum of their radii: one sphere above what it is laid out for
    loses no partner as long as its sums with another and with a face fit, and is an error above."""
    scene = scene_of(scenes, "p p p")

    def grown(growth):
        return (
            scene.head()
            + scene.cortex()
            + spheres_that_grow(scene, scenes, f"growth {growth}")
            + "run 2\nvariable first equal bound(balls,xmin)+1e-6\n"
            + "variable left atom x<=v_first\ngroup left variable left\n"
            + "group one intersect left balls\n"
            + f"set group one diameter {diameter}\nrun 50 pre no\n"
        )

    result = lmp.run(grown(1.05))  # laid out for 5.25
    assert result.returncode == 0 or diameter > 11.0, result.tail()
    if diameter > 11.0:  # 5.55 and 5
        assert result.returncode != 0
        assert "beyond the 5.25 that" in result.error
        return
    wide = lmp(grown(1.3))
    assert result.returncode == 0
    for a, b in zip(result.dump(), wide.dump(), strict=True):
        assert sum(a.radius == diameter / 2) == (1 if a.step > 2 else 0)
        for name in ("x", "f"):
            assert np.allclose(getattr(a, name), getattr(b, name), atol=1e-9)


def test_growth_beyond_the_promise(lmp, scenes):
    """An error that says what to do; between runs the list is laid out anew, and the log tells."""
    scene = scene_of(scenes, "p p p")
    head = scene.head() + scene.cortex()
    deck = head + spheres_that_grow(scene, scenes, "growth 1.05") + "restart 10 r.*\nrun 20\n"
    result = lmp.run(deck + GROW.format(20))
    assert result.returncode != 0
    assert "Pair style dcm/contact: the sphere" in result.error
    assert "beyond the 5.25 that the neighbor list is laid out for" in result.error
    assert "'pair_style dcm/contact ... growth 1.312'" in result.error

    files = {"r.20": result.path / "r.20"}
    deck = "read_restart r.20\n" + spheres_that_grow(scene, scenes, "growth 1.312")
    lmp(deck + "run 0\n" + GROW.format(20), files=files)

    deck = head + spheres_that_grow(scene, scenes, "") + "run 2\nset group balls diameter 11\n"
    result = lmp(deck + "run 2\n")
    assert "atom type 4 up to 5.5, neighbor list laid out for 5.5 (before 5)" in result.log


# --- the form of the coefficients in a restart file -----------------------------------------------

MAGIC = b"DCM-re2\n"  # what a record begins with; then style, version, size: dcm_record.h


def later(data, at):
    data[at + 48 : at + 56] = (9).to_bytes(8, "little")


def without_number(data, at):
    data[at : at + 4] = b"DCMC"


def of_another_package(data, at):
    data[at : at + 80] = bytes(80)


def changed(data, at):
    data[at + 83] ^= 1


OTHER = {
    later: "has version 9, this program reads version 2; use the version of the package",
    without_number: "was not written by this style, or by a version of the package whose records",
    of_another_package: "was not written by this style",
    changed: "is damaged; use an earlier restart file",
}


@pytest.mark.parametrize("form", OTHER)
@pytest.mark.parametrize("style", ["Bond style dcm/cortex", "Dihedral style dcm/bend"])
def test_other_form_of_coefficients(lmp, scenes, style, form):
    """A restart file whose coefficients have another form is refused, not read as garbage."""
    scene = scenes.single_cell()
    deck = scene.head() + scene.cortex() + "comm_modify cutoff 14\nfix cell all dcm/cell\n"
    whole = lmp(deck + scene.volume() + "run 0\nwrite_restart x.restart\n")
    data = bytearray((whole.path / "x.restart").read_bytes())
    assert data.count(MAGIC + style.encode()) == 1
    form(data, data.find(MAGIC + style.encode()))
    path = whole.path / "other.restart"
    path.write_bytes(data)
    result = lmp.run("read_restart other.restart\n", files={"other.restart": path})
    assert result.returncode != 0, result.tail()
    error = result.error.replace("\n", " ")
    assert f"{style}: its record in the restart file {OTHER[form]}" in error, result.tail()
