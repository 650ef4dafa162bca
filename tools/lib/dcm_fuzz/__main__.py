"""The loop of tools/fuzz: make a case, run it, keep what ends badly."""

import argparse
import re
import shutil
import sys
import time
from pathlib import Path

from .cases import KINDS, Maker, read_case
from .judge import Judge
from .minimize import Minimizer

SHARE = dict(deck=5, wild=5, words=3, data=3, rest=1, restart=2, mesh=2, table=1, parameters=2)


def parse(argv):
    parser = argparse.ArgumentParser(prog="tools/fuzz", add_help=False)
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--cases", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=KINDS, action="append", default=[])
    parser.add_argument("--folder", default="")
    parser.add_argument("--replay", nargs="+", default=[])
    parser.add_argument("--one", type=int, default=None)
    parser.add_argument("--no-minimize", action="store_true")
    parser.add_argument("--ranks", type=int, default=4)
    parser.add_argument("--sanitize", action="store_true")
    return parser.parse_args(argv)


def order(kinds, share=SHARE):
    """Kinds in turn, each as often as its share."""
    turns = [kind for kind in kinds for _ in range(share[kind])]
    step = next(s for s in range(7, 100) if all(s % p or len(turns) % p for p in range(2, 50)))
    return [turns[k * step % len(turns)] for k in range(len(turns))]


class Session:
    def __init__(self, args):
        self.args = args
        self.folder = Path(args.folder or "fuzz").resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.judge = Judge(self.folder, args.sanitize, args.ranks)
        self.maker = Maker(self.judge)
        self.counts, self.faults, self.refusals = {}, {}, {}

    def say(self, text):
        print(f"[fuzz {time.strftime('%H:%M:%S')}] {text}", flush=True)

    def look(self, case):
        verdict = self.judge(case)
        kinds = self.counts.setdefault(case.kind, {})
        kinds[verdict.kind] = kinds.get(verdict.kind, 0) + 1
        if verdict.good:
            self.refusals[verdict.signature] = self.refusals.get(verdict.signature, 0) + 1
            return
        if verdict.signature in self.faults:
            self.faults[verdict.signature][0] += 1
            return
        self.say(f"FAULT {case.kind} {case.seed}: {verdict.kind}: {verdict.message[:300]}")
        kept = self.folder / "faults" / name_of(len(self.faults) + 1, verdict)
        self.faults[verdict.signature] = [1, kept.name, verdict]
        keep(case, kept, verdict)
        if not self.args.no_minimize:
            small = Minimizer(self.judge, verdict.signature)(case)
            shutil.rmtree(kept)
            keep(small, kept, verdict)

    def loop(self):
        args = self.args
        kinds = order(args.only or KINDS)
        end, last = time.monotonic() + 60 * args.minutes, time.monotonic()
        done = 0
        while done < args.cases if args.cases else time.monotonic() < end:
            case = self.maker(kinds[done % len(kinds)], 1000000 * args.seed + done)
            self.look(case)
            done += 1
            if time.monotonic() - last > 60:
                last = time.monotonic()
                self.say(f"{done} cases, {self.judge.runs} runs, {len(self.faults)} faults")
        return done

    def table(self):
        columns = ["ran", "refused", *sorted({k for c in self.counts.values() for k in c}
                                             - {"ran", "refused"})]  # fmt: skip
        print(f"\n{'kind':12}" + "".join(f"{c:>14}" for c in columns))
        for kind, counts in self.counts.items():
            print(f"{kind:12}" + "".join(f"{counts.get(c, 0):14}" for c in columns))
        print(f"\n{self.judge.runs} runs, {len(self.refusals)} different messages, "
              f"{len(self.faults)} different faults")  # fmt: skip
        for count, name, verdict in self.faults.values():
            print(f"  {count:4} x {name}: {verdict.message[:160]}")
        with open(self.folder / "messages", "w") as file:
            for message, count in sorted(self.refusals.items()):
                file.write(f"{count:5} {message}\n")


def name_of(number, verdict):
    words = re.sub(r"[^A-Za-z]+", "_", verdict.signature)[:50].strip("_")
    return f"{number:03}_{words}"


def keep(case, path, verdict):
    if case.np > 1 and "# ranks" not in case.deck:
        case = case.with_deck(f"# ranks {case.np}\n{case.deck}")
    if case.compare and verdict.kind == "ranks differ":
        case = case.with_deck(f"# compare\n{case.deck}")
    case.write(path)
    (path / "README").write_text(
        f"{case.kind} {case.seed}, {case.np} ranks: {verdict.kind}\n{verdict.message}\n"
        "run: tools/fuzz --replay <this folder>\n"
    )


def main(argv):
    args = parse(argv)
    session = Session(args)
    if args.replay:
        bad = 0
        for path in args.replay:
            verdict = session.judge(read_case(path))
            bad += not verdict.good
            print(f"{path}: {verdict.kind} {verdict.message}")
        return bool(bad)
    if args.one is not None:
        case = session.maker((args.only or KINDS)[0], args.one)
        verdict = session.judge(case)
        print(case.deck, f"\n{verdict.kind}: {verdict.message}")
        return not verdict.good
    try:
        session.loop()
    except KeyboardInterrupt:
        session.say("stopped")
    session.table()
    return bool(session.faults)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
