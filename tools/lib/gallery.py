"""Pictures of the manual from those of runs.

  python gallery.py RUNS                       doc/img/gallery/NAME.png from RUNS/NAME/picture.png,
                                               as tools/run leaves it, for all that are there
  python gallery.py tiles OUT A.png B.png ...  pictures beside each other, four in a row
"""
import sys
from pathlib import Path

from PIL import Image

GALLERY = Path(__file__).resolve().parents[2] / "doc/img/gallery"
SIZE = 420    # pixel


def small(path, size=SIZE):
    """A picture at most `size` pixel wide and high."""
    with Image.open(path) as file:
        image = file.convert("RGB")
    image.thumbnail((size, size), Image.Resampling.LANCZOS)
    return image


def save(image, path):
    """As a PNG of 256 colors, which takes a third of the room."""
    path.parent.mkdir(parents=True, exist_ok=True)
    image.quantize(256, dither=0).save(path, optimize=True)
    print(f"wrote {path}")


def main(words):
    if words[0] == "tiles":
        images = [small(path) for path in words[2:]]
        across, (wide, high) = min(4, len(images)), images[0].size
        sheet = Image.new("RGB", (across * wide, -(-len(images) // across) * high), "white")
        for k, image in enumerate(images):
            sheet.paste(image, (k % across * wide, k // across * high))
        save(sheet, Path(words[1]))
        return
    for path in sorted(Path(words[0]).glob("*/picture.png")):
        save(small(path), GALLERY / f"{path.parent.name}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
