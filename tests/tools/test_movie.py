"""Movies from pictures of one color each."""
import os

import pytest
from PIL import Image

from lammps_dcm.__main__ import main
from lammps_dcm.movie import find_pictures

COLORS = {1: (255, 0, 0), 9: (0, 255, 0), 10: (0, 0, 255), 100: (255, 255, 0)}


@pytest.fixture
def pictures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number, color in COLORS.items():
        Image.new("RGB", (40, 30), color).save(f"run2.{number}.png")
    return "run2.*.png"


def frames(path):
    """List of (size, color of the middle pixel, duration in ms)."""
    found = []
    with Image.open(path) as movie:
        for k in range(movie.n_frames):
            movie.seek(k)
            middle = movie.convert("RGB").getpixel((movie.width // 2, movie.height // 2))
            found.append((movie.size, middle, movie.info["duration"]))
        assert movie.info["loop"] == 0
    return found


def test_gif_in_the_order_of_numbers(pictures, capsys):
    assert main(["movie", pictures]) == 0
    assert frames("movie.gif") == [((40, 30), color, 100) for color in COLORS.values()]
    assert "4 pictures from run2.1.png to run2.100.png, 0.4 s" in capsys.readouterr().out


def test_scale_speed_and_names_one_by_one(pictures):
    words = ["run2.10.png", "run2.9.png", "run2.9.png", "--fps", "25", "--scale", "0.5"]
    assert main(["movie", *words, "-o", "m.gif"]) == 0
    assert frames("m.gif") == [((20, 15), COLORS[9], 40), ((20, 15), COLORS[10], 40)]


def test_transparent_parts_become_white(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Image.new("RGBA", (8, 8), (0, 0, 0, 0)).save("a.1.png")
    assert main(["movie", "a.1.png"]) == 0
    assert frames("movie.gif")[0][1] == (255, 255, 255)


def test_background_keeps_its_color(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    noise = [Image.effect_noise((300, 300), spread) for spread in (100, 40, 10)]
    picture = Image.merge("RGB", noise)    # more colors than a GIF has
    near = picture.point(lambda v: 255 - v % 8).crop((0, 0, 300, 100))    # almost white
    picture.paste(near, (0, 100))
    picture.paste((255, 255, 255), (0, 0, 300, 100))
    picture.save("a.1.png")
    assert main(["movie", "a.1.png"]) == 0
    with Image.open("movie.gif") as movie:
        assert movie.convert("RGB").getpixel((150, 50)) == (255, 255, 255)


def test_order_without_numbers_and_across_folders(tmp_path):
    (tmp_path / "b").mkdir()
    for name in ("end.png", "f.2.png", "f.10.png", "b/f.9.png"):
        (tmp_path / name).touch()
    found = find_pictures([str(tmp_path / "*.png"), str(tmp_path / "b" / "*")])
    assert [os.path.relpath(p, tmp_path) for p in found] == ["end.png", "f.2.png", "b/f.9.png",
                                                             "f.10.png"]


@pytest.mark.parametrize("words, says", [
    ("none.*.png", "no file none.*.png"), ("run2.*.png -o m.avi", "-o m.avi"),
    ("run2.*.png --fps 0", "--fps"), ("run2.*.png --fps 90", "--fps"),
    ("run2.*.png --scale 0", "--scale"), ("run2.*.png the.big.png", "the.big.png: 60 x 60"),
    ("run2.*.png cut.png", "cut.png cannot be read"), ("run2.9.png m.gif -o m.gif", "one of the")])
def test_messages_and_nothing_is_left_behind(pictures, tmp_path, words, says, capsys):
    Image.new("RGB", (60, 60)).save("the.big.png")
    Image.effect_noise((40, 30), 50).save("whole.png")
    (tmp_path / "cut.png").write_bytes((tmp_path / "whole.png").read_bytes()[:-300])
    (tmp_path / "m.gif").write_bytes(b"old")
    (tmp_path / "movie.gif").write_bytes(b"old")
    before = sorted(os.listdir())
    assert main(["movie", *words.split()]) == 1
    assert says in capsys.readouterr().err
    assert sorted(os.listdir()) == before
    assert (tmp_path / "m.gif").read_bytes() == (tmp_path / "movie.gif").read_bytes() == b"old"


def fake_ffmpeg(tmp_path, monkeypatch, script):
    """A program ffmpeg on PATH that does `script`, $out being its last argument."""
    folder = tmp_path / "bin"
    folder.mkdir()
    program = folder / "ffmpeg"
    program.write_text('#!/bin/sh\nfor out; do :; done\necho "$@" > args\n' + script)
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


def test_mp4_goes_through_ffmpeg(pictures, tmp_path, monkeypatch):
    fake_ffmpeg(tmp_path, monkeypatch, 'cat > "$out"\n')
    assert main(["movie", pictures, "-o", "m.mp4", "--fps", "5"]) == 0
    assert (tmp_path / "m.mp4").read_bytes() == b"".join(bytes(c) * 1200 for c in COLORS.values())
    assert "-s 40x30 -r 5 -i -" in (tmp_path / "args").read_text()


def test_failing_ffmpeg_leaves_nothing(pictures, tmp_path, monkeypatch, capsys):
    fake_ffmpeg(tmp_path, monkeypatch, 'echo half > "$out"\nexit 3\n')
    assert main(["movie", pictures, "-o", "m.mp4"]) == 1
    assert "status 3" in capsys.readouterr().err
    assert not list(tmp_path.glob("*m.mp4*"))


def test_mp4_without_ffmpeg_says_what_to_do(pictures, tmp_path, monkeypatch, capsys):
    import sys

    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)    # as if it were not installed
    assert main(["movie", pictures, "-o", "m.mp4"]) == 1
    assert "apt install ffmpeg" in capsys.readouterr().err
