"""The smallest deck and the least damage that still fail alike."""

import difflib


class Minimizer:
    def __init__(self, judge, signature, most=80):
        self.judge, self.signature = judge, signature
        self.left = most // 8 if signature.startswith("hang") else most

    def fails(self, case):
        if self.left <= 0:
            return False
        self.left -= 1
        return self.judge(case).signature == self.signature

    def __call__(self, case):
        for name in sorted(case.whole):
            case = self.damage(case, name)
        return self.lines(case)

    def lines(self, case):
        """Leave out lines of the deck, in ever smaller pieces."""
        lines = case.deck.splitlines()
        size = max(1, len(lines) // 2)
        while size >= 1 and self.left > 0:
            k = 0
            while k < len(lines) and self.left > 0:
                fewer = lines[:k] + lines[k + size :]
                tried = case.with_deck("\n".join(fewer) + "\n")
                if self.fails(tried):
                    case, lines = tried, fewer
                else:
                    k += size
            size //= 2
        return case

    def damage(self, case, name):
        """Undo those changes of a text file that do not matter."""
        whole = case.whole[name].decode("latin1").split("\n")
        now = case.files[name].decode("latin1").split("\n")
        changes = difflib.SequenceMatcher(None, whole, now, autojunk=False).get_opcodes()
        changes = [c for c in changes if c[0] != "equal"]
        if not 1 < len(changes) < 30:
            return case
        kept = list(changes)
        for change in changes:
            tried = [c for c in kept if c is not change]
            text = apply(whole, now, tried)
            new = case.with_file(name, "\n".join(text).encode("latin1"))
            if self.fails(new):
                kept, case = tried, new
        return case


def apply(whole, now, changes):
    text, at = [], 0
    for _, i1, i2, j1, j2 in changes:
        text += whole[at:i1] + now[j1:j2]
        at = i2
    return text + whole[at:]
