"""Options that the commands share: the files of a run, frames, moduli."""


def load_run(args, frames):
    """Universe of the files that the command line names, ready for `frames`, a text as that of
    --frame: only these are searched for atom IDs."""
    from . import load

    try:
        scan = [int(frames)]
    except ValueError:
        scan = "all"
    if args.dump is None and args.data is None:
        raise ValueError("give a dump, --data FILE, or both")
    return load(args.data, args.dump, dt=getattr(args, "dt", None) or 1.0, scan=scan,
                rename=pairs(args.rename, "--rename"))


def pairs(text, option, value=str):
    """Dict from command-line text NAME=VALUE,NAME=VALUE,..."""
    found = {}
    for word in text.split(",") if text else []:
        name, equals, given = word.partition("=")
        if not (name and equals and given):
            raise ValueError(f"{option} {text}: write NAME=VALUE,NAME=VALUE,...")
        found[name] = value(given)
    return found


def bulk_modulus_of(text):
    """K_V, kPa, from `2.5` or `TYPE=2.5,TYPE=3`; None if not given."""
    if text is None:
        return None
    try:
        return pairs(text, "", float) if "=" in text else float(text)
    except ValueError:
        raise ValueError(f"--bulk-modulus {text}: give one number, kPa, or TYPE=NUMBER,... for "
                         "every type of center atom") from None


def chosen_frames(text, count):
    """Numbers of the frames that --frame `text` means, of `count` frames."""
    try:
        return range(count) if text == "all" else [range(count)[int(text)]]
    except (ValueError, IndexError):
        raise ValueError(f"--frame {text}: there are {count} frames, give 0 to {count - 1}, "
                         "a negative number from the end, or all") from None


def add_input(parser, pressures=True):
    """The options that name the files of a run, and with `pressures` that for the modulus."""
    parser.add_argument("dump", nargs="?", help="text dump (dump custom), plain or .gz")
    parser.add_argument("--data", help="data file: faces, radii, rest volumes")
    parser.add_argument("--rename", metavar="COLUMN=NAME,...", help="dump columns to "
                        "rename, such as c_face[2]=contact_area")
    if pressures:
        parser.add_argument("--bulk-modulus", metavar="K_V", help="kPa: one number, or "
                            "TYPE=NUMBER,... for every atom type of a center; for pressures")
