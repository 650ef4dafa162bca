"""Movies: the pictures of `dump image` or of `render --frame all` as an animated GIF or an .mp4."""
import contextlib
import glob
import os
import re
import shutil
import subprocess
from pathlib import Path

from tqdm import tqdm


def number_key(path):
    """Sort key that takes runs of digits for numbers: frame.9.png comes before frame.10.png."""
    words = re.split(r"(\d+)", Path(path).name)
    return [int(w) if k % 2 else w for k, w in enumerate(words)], str(path)


def find_pictures(patterns):
    """Files that `patterns` (names, or with * ? [ ]) stand for, once each, by their numbers."""
    found = set()
    for pattern in patterns:
        files = [pattern] if Path(pattern).exists() else glob.glob(pattern)
        if not files:
            raise FileNotFoundError(f"no file {pattern}")
        found.update(map(str, map(Path, files)))
    return sorted(found, key=number_key)


def read_picture(path, scale=1.0, expected=None):
    """Picture as RGB Image, transparent parts white, scaled. expected: (width, height), pixel, that
    the file must have; the error names the file."""
    from PIL import Image

    try:
        with Image.open(path) as file:
            image = file.convert("RGBA")
    except (OSError, SyntaxError, EOFError) as err:    # Pillow's errors do not name the file
        raise ValueError(f"{path} cannot be read ({err}): if LAMMPS still writes it, leave it "
                         "out") from None
    if expected and image.size != expected:
        raise ValueError("{}: {} x {} pixel, the first picture has {} x {}: give pictures of one "
                         "size".format(path, *image.size, *expected))
    white = Image.new("RGBA", image.size, "white")
    image = Image.alpha_composite(white, image).convert("RGB")
    if scale != 1.0:
        size = [max(1, round(scale * length)) for length in image.size]
        image = image.resize(size, Image.Resampling.LANCZOS)
    return image


def common_palette(images):
    """Image with one palette of 256 colors for all `images`: a palette per frame would flicker."""
    from PIL import Image

    small = [image.resize([max(1, min(200, length)) for length in image.size],
                          Image.Resampling.NEAREST) for image in images]
    strip = Image.new("RGB", (sum(s.width for s in small), max(s.height for s in small)), "white")
    left = 0
    for image in small:
        strip.paste(image, (left, 0))
        left += image.width
    palette = strip.quantize(256, dither=0)
    # its colors are means of similar ones; the background shall stay exactly what it is. Pillow
    # does not always find the nearest color, so change the one that it finds until that holds
    _, ground = max(strip.getcolors(strip.width * strip.height))
    pixel, colors = Image.new("RGB", (1, 1), ground), palette.getpalette()
    for _ in range(256):
        at = 3 * pixel.quantize(palette=palette, dither=0).getpixel((0, 0))
        if colors[at:at + 3] == list(ground):
            break
        colors[at:at + 3] = ground
        palette.putpalette(colors)
    return palette


def write_gif(pictures, read, output, fps):
    """Write an endless animated GIF. read: function path -> RGB Image. GIF counts time in 1/100 s,
    so that the time of a frame is rounded to that."""
    every = max(1, len(pictures) // 12)
    palette = common_palette([read(p) for p in pictures[::every]])
    frames = (read(p).quantize(palette=palette, dither=0)
              for p in tqdm(pictures, desc="frames", disable=None, leave=False))
    next(frames).save(output, format="GIF", save_all=True, append_images=frames, loop=0,
                      duration=10 * max(1, round(100.0 / fps)))


def find_ffmpeg():
    """Path of ffmpeg: installed, or that of the Python package imageio-ffmpeg."""
    program = shutil.which("ffmpeg")
    if program is None:
        try:
            import imageio_ffmpeg

            program = imageio_ffmpeg.get_ffmpeg_exe()
        except (ImportError, RuntimeError):
            raise ValueError("an .mp4 takes ffmpeg, and there is none: install it (Debian: apt "
                             "install ffmpeg; or pip install imageio-ffmpeg), or write a .gif") \
                from None
    return program


def write_mp4(pictures, read, output, fps):
    """Write an H.264 movie through ffmpeg; odd widths and heights lose a pixel, as that needs."""
    program = find_ffmpeg()
    width, height = read(pictures[0]).size
    child = subprocess.Popen(
        [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
         f"{width}x{height}", "-r", f"{fps:g}", "-i", "-", "-vf", "crop=trunc(iw/2)*2:"
         "trunc(ih/2)*2", "-pix_fmt", "yuv420p", "-f", "mp4", str(output)],
        stdin=subprocess.PIPE)
    try:
        for path in tqdm(pictures, desc="frames", disable=None, leave=False):
            child.stdin.write(read(path).tobytes())
    except BrokenPipeError:
        pass    # ffmpeg stopped; its status tells
    finally:
        with contextlib.suppress(BrokenPipeError):
            child.stdin.close()
        status = child.wait()
    if status:
        raise ValueError(f"ffmpeg stopped with status {status}, see its message above")


WRITERS = {".gif": write_gif, ".mp4": write_mp4}


def make_movie(pictures, output, fps=10.0, scale=1.0):
    """Assemble picture files, in the order given, into `output` (.gif or .mp4). fps: pictures per
    second; scale: of width and height. `output` is replaced only once the movie is complete."""
    output = Path(output)
    writer = WRITERS.get(output.suffix.lower())
    if writer is None:
        raise ValueError(f"-o {output}: give a name that ends in {' or '.join(WRITERS)}")
    most = 50.0 if writer is write_gif else 1000.0
    if not 0.1 <= fps <= most:
        raise ValueError(f"--fps {fps:g}: give 0.1 to {most:g} (viewers show a faster GIF slowly)")
    if not 0.0 < scale <= 10.0:
        raise ValueError(f"--scale {scale:g}: give a factor above 0, at most 10")
    if output.resolve() in [Path(p).resolve() for p in pictures]:
        raise ValueError(f"-o {output} is one of the pictures: give another name")
    expected = read_picture(pictures[0]).size
    part = output.with_name(f".{output.name}.part")
    try:
        writer(pictures, lambda path: read_picture(path, scale, expected), part, fps)
        os.replace(part, output)
    finally:
        part.unlink(missing_ok=True)


# ---------------------------------------------------------------------- command line

def add_arguments(parser):
    """Options of `movie`."""
    parser.add_argument("pictures", nargs="+", metavar="PICTURES", help="files, or a quoted "
                        "pattern such as 'frame.*.png'; sorted by the numbers in their names")
    parser.add_argument("-o", "--output", default="movie.gif", help=".gif, or .mp4 if ffmpeg is "
                        "there (default: %(default)s)")
    parser.add_argument("--fps", type=float, default=10.0, help="pictures per second (default: "
                        "%(default)g)")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on width and height "
                        "(default: %(default)g)")


def run(args, words):
    """Assemble the movie the command line asks for."""
    pictures = find_pictures(args.pictures)
    make_movie(pictures, args.output, args.fps, args.scale)
    size = Path(args.output).stat().st_size
    print(f"wrote {args.output}: {len(pictures)} pictures from {pictures[0]} to {pictures[-1]}, "
          f"{len(pictures) / args.fps:.3g} s, {size / 2**20:.2g} MB")
