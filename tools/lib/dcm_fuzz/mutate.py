"""Damage to text and binary files, of the kinds that hands, editors, transfers and disks do."""

import struct

# numbers at which programs break, and words that are none
ABSURD = [
    "0", "-0", "-1", "1", "2", "0.5", "1e-12", "1e-300", "1e300", "1.8e308", "-1e300", "1e18",
    "nan",
    "inf", "-inf", "2147483647", "2147483648", "-2147483648", "9223372036854775807", "4294967296",
    "99999", "1e5", "1e", "0x10", "1,5", "1_000", "abc", "NULL", "*", "v_none", "c_none", "f_none",
    "all", "-", "--", ".", "''", "1.5", "3.0", "+1", "1e9", "1e-5", "-1e-5", "INF", "yes", "no",
]  # fmt: skip


def pick(rng, items):
    return items[int(rng.integers(len(items)))]


def near(rng, word):
    """A number a little or a lot different from this one; None if it is no number."""
    try:
        value = float(word)
    except ValueError:
        return None
    whole = word.lstrip("-").isdigit()
    how = rng.integers(6)
    if how == 0:
        value = -value
    elif how == 1:
        value *= 10.0 ** rng.integers(-6, 7)
    elif how == 2:
        value += 1
    elif how == 3:
        value -= 1
    elif how == 4:
        value *= rng.uniform(0.5, 2.0)
    else:
        value += rng.normal()
    return str(int(value)) if whole and abs(value) < 1e18 else repr(float(value))


def a_word(rng, lines):
    """Another word for one of a line; now and then that of another line."""
    k = int(rng.integers(len(lines)))
    words = lines[k].split()
    if not words:
        return
    n = int(rng.integers(len(words)))
    how = rng.integers(5)
    if how == 0:
        new = pick(rng, ABSURD)
    elif how == 1:
        others = pick(rng, lines).split() or [""]
        new = pick(rng, others)
    elif how == 2 and len(words) > 1:
        m = int(rng.integers(len(words)))
        words[m], new = words[n], words[m]
    elif how == 3:
        new = ""
    else:
        new = near(rng, words[n]) or pick(rng, ABSURD)
    words[n] = new
    lines[k] = " ".join(words)


def a_line(rng, lines):
    k, m = (int(rng.integers(len(lines))) for _ in range(2))
    how = rng.integers(6)
    if how == 0:
        del lines[k]
    elif how == 1:
        lines.insert(m, lines[k])
    elif how == 2:
        lines[k], lines[m] = lines[m], lines[k]
    elif how == 3:
        lines[k] += " " + lines[m]
    elif how == 4:
        lines.insert(k, "")
    else:
        lines.insert(m, lines.pop(k))


def a_block(rng, lines):
    """Some lines moved, doubled or lost."""
    k = int(rng.integers(len(lines)))
    block = lines[k : k + int(rng.integers(1, 1 + max(1, len(lines) // 4)))]
    how = rng.integers(3)
    if how != 1:
        del lines[k : k + len(block)]
    if how != 0:
        m = int(rng.integers(len(lines) + 1))
        lines[m:m] = block


def text_once(rng, data):
    """`data` (bytes) with one damage."""
    how = rng.integers(20)
    if how < 15:
        lines = data.decode("latin1").split("\n")
        if how < 9:
            a_word(rng, lines)
        elif how < 13:
            a_line(rng, lines)
        else:
            a_block(rng, lines)
        return "\n".join(lines).encode("latin1")
    at = int(rng.integers(len(data) + 1))
    if how == 15:
        return data[:at]
    if how == 16:
        return data[:at] + bytes([int(rng.integers(256))]) + data[at + 1 :]
    if how == 17:
        strange = pick(rng, [b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"#", b"&\n", b'"', b"$", b"\r"])
        return data[:at] + strange + data[at:]
    if how == 18:
        return data.replace(b"\n", pick(rng, [b"\r\n", b"\r", b"\n\n", b" "]))
    return data[:at] + pick(rng, [b"9", b"x", b" "]) * int(rng.integers(1, 20000)) + data[at:]


def text(rng, data):
    """`data` with one damage or some."""
    for _ in range(1 + int(rng.geometric(0.6)) - 1):
        data = text_once(rng, data)
        if not data:
            break
    return data


def binary(rng, data, start, stop):
    """A restart file cut, or with numbers changed between two places."""
    how = rng.integers(8)
    if how == 0:
        return data[: int(rng.integers(len(data)))]
    data = bytearray(data)
    for _ in range(int(rng.geometric(0.6))):
        at = int(rng.integers(start, stop))
        if how < 4:
            data[at] ^= 1 << int(rng.integers(8))
        elif how < 6:
            value = pick(rng, [0, -1, 1, 2**31 - 1, -(2**31), 10**6, 7])
            data[at : at + 4] = struct.pack("<i", value)
        else:
            value = pick(rng, [0.0, float("nan"), float("inf"), -1.0, 1e300, 1e-300])
            data[at : at + 8] = struct.pack("<d", value)
    return bytes(data)
