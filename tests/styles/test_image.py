"""dump image through fix dcm/cell."""

import pytest


@pytest.mark.parametrize("np_", [1, 2])
def test_picture_of_a_doublet(lmp, scenes, np_):
    plt = pytest.importorskip("matplotlib.image")
    scene = scenes.doublet(level=2)
    result = lmp(
        scene.head()
        + scene.forces()
        + "group none empty\n"
        + "dump picture none image 1 picture.*.png type type fix cell type 1 0.05 size 200 150 "
        + "box no 0.0 zoom 3.0\n"
        + "dump_modify picture backcolor white acolor 3 green\n"
        + "run 0\n",
        np=np_,
    )
    picture = plt.imread(result.path / "picture.0.png")
    assert picture.shape[:2] == (150, 200)
    green = (picture[..., 1] > picture[..., 0] + 0.1) & (picture[..., 1] > picture[..., 2] + 0.1)
    assert 0.05 < green.mean() < 0.8  # surfaces
    assert (picture[..., :3].min(axis=2) > 0.99).mean() > 0.1  # background
    assert len({tuple(p) for p in picture[green].round(3)}) > 20  # shading
