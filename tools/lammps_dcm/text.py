"""Text files that the tools write and read: UTF-8, and whole or not at all."""
import os
from pathlib import Path

# file names that the locale cannot decode come as surrogates and go back as the same bytes
ENCODING = {"encoding": "utf-8", "errors": "surrogateescape"}


def read_text(path):
    """The text of a file, without the mark (BOM) that some editors put in front."""
    return Path(path).read_text(**ENCODING).removeprefix("\ufeff")


def write_text(path, text):
    """Write a file; an old one stays as it is if this fails."""
    path, data = Path(path), text.encode(**ENCODING)
    if path.exists() and not path.is_file():    # a device or pipe
        path.write_bytes(data)
        return
    target = Path(os.path.realpath(path))
    part = target.with_name(target.name + ".part")
    try:
        part.write_bytes(data)
        os.replace(part, target)
    except OSError:
        part.unlink(missing_ok=True)
        raise
