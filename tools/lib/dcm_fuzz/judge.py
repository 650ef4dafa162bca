"""Run a case through the real lmp and say how it ended.

Good: return code 0 with finite numbers, or exactly one error that names a style or a file. A fault
is all else: a signal, a hang, a number that is none without an error, an exception that nobody
caught, an error without context, a rest file left damaged, another result on other ranks.
"""

import contextlib
import os
import re
import resource
import shutil
import signal
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
KEEP, GUARDED = b"of an earlier run\n", ("division.log", "death.log")
CPU = 20  # s of processor time on each rank; a paused machine is no hang
NAMED = re.compile(
    r"dcm/|[Cc]reate_cells|[Aa]tom.style dcm|[Ff]ix_modify|file |mesh|log |lumen|parameter"
)
# what some numbers of ranks do not allow, with its remedy
LIMIT = re.compile(r"comm_modify|comm_style|processors|ranks|fewer processes")
SANITIZER = re.compile(r"(runtime error: .*|ERROR: AddressSanitizer: \S+|ERROR: LeakSan\S+)")
FRAME = re.compile(r"#\d+ .* in (.*?)(?:\(.*)? (\S*?/?src/\S+?|\S+\.(?:cpp|h)):(\d+)")
# a report of a thread of Open MPI that never was in this program: when MPI_Abort ends a run it
# reads a message that another of its threads has freed
OPEN_MPI = re.compile(r"libopen-rte|libopen-pal|libpmix|openmpi/")
PROGRAM = re.compile(r"LAMMPS_NS|dcm::|dcmplugin|/lmp\b")
NUMBER = re.compile(r"[-+]?\d[\d.]*(?:[eE][-+]?\d+)?")


def of_open_mpi(report):
    """Whether the access that a sanitizer reports is Open MPI's own: its first stack tells."""
    stack = report.partition("\n\n")[0]
    return bool(OPEN_MPI.search(stack)) and not PROGRAM.search(stack)


class Verdict:
    """kind: 'ran', 'refused' or the kind of fault; signature: what tells faults apart."""

    GOOD = ("ran", "refused")

    def __init__(self, kind, message="", signature=None):
        self.kind, self.message = kind, message.strip()
        self.signature = f"{kind}: {self.message if signature is None else signature}"

    @property
    def good(self):
        return self.kind in self.GOOD


def without_numbers(text):
    return NUMBER.sub("N", text)[:160]


class Judge:
    def __init__(self, folder, sanitize=False, np_max=4):
        self.folder, self.sanitize, self.np_max = Path(folder), sanitize, np_max
        self.lmp = os.environ["DCM_LMP"]
        self.runs = 0
        self.env = {
            **os.environ,
            "OMP_NUM_THREADS": "1",
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_hwloc_base_binding_policy": "none",
            "OMPI_MCA_mpi_yield_when_idle": "1",
        }
        self.env.setdefault("LAMMPS_PLUGIN_PATH", os.environ.get("DCM_BUILD", ""))
        self.env["LAMMPS_POTENTIALS"] = str(ROOT / "potentials")
        self.cpu = CPU * (4 if sanitize else 1)

    # --- running --------------------------------------------------------------------------------

    def limits(self):
        resource.setrlimit(resource.RLIMIT_CPU, (self.cpu, self.cpu + 5))
        resource.setrlimit(resource.RLIMIT_FSIZE, (2**28, 2**28))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if not self.sanitize:  # its shadow memory takes terabytes of addresses
            resource.setrlimit(resource.RLIMIT_AS, (2**33, 2**33))
        os.setpgid(0, 0)

    def start(self, case, path, np=None, prefix=()):
        """Run in `path`; (return code, text of the screen, of standard error)."""
        shutil.rmtree(path, ignore_errors=True)
        case.write(path)
        np = np or case.np
        command = [*prefix, self.lmp, "-in", "in.deck", "-nocite"]
        if np > 1:
            command = [os.environ.get("DCM_MPIEXEC", "mpirun"), "-np", str(np), *command]
        self.runs += 1
        with open(path / "out", "wb") as out, open(path / "err", "wb") as err:
            child = subprocess.Popen(
                command, cwd=path, env=self.env, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                preexec_fn=self.limits,
            )  # fmt: skip
            try:
                code = child.wait(timeout=20 * self.cpu)
            except subprocess.TimeoutExpired:
                code = "late"
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)
            child.wait()
        texts = [(path / name).read_bytes().decode("latin1") for name in ("out", "err")]
        return code, *texts

    def __call__(self, case, np=None):
        path = self.folder / "run"
        code, out, err = self.start(case, path, np)
        verdict = self.read(code, out, err, path)
        if verdict.kind == "crash" and not self.sanitize:
            verdict = Verdict("crash", f"{verdict.message} {self.trace(case, np)}")
        if verdict.kind == "ran" and case.compare and np is None and case.np == 1:
            verdict = self.other_ranks(case, verdict, thermo(path))
        return verdict

    def trace(self, case, np):
        """The innermost function of the package in which it crashed, by gdb if it is there."""
        if not shutil.which("gdb") or (np or case.np) > 1:
            return ""
        gdb = ("gdb", "-batch", "-nx", "-ex", "run", "-ex", "bt 30", "--args")
        _, out, _ = self.start(case, self.folder / "gdb", 1, gdb)
        frames = re.findall(r"^#\d+ +(?:0x\w+ in )?(.*?) \(.*", out, re.M)
        ours = [f for f in frames if "DCM" in f or "dcm" in f or "CreateCells" in f]
        first = next((f for f in frames if not f.startswith(("__", "raise", "abort", "??"))), "")
        return f"in {ours[0] if ours else first}"[:120]

    # --- reading --------------------------------------------------------------------------------

    def read(self, code, out, err, path):
        both = out + "\n" + err
        found = SANITIZER.search(both)
        if found and not of_open_mpi(both[found.start() :]):
            frames = FRAME.findall(both[found.start() :])
            ours = [f for f in frames if "/src/DCM/" in f[1] or "plugin" in f[1]] or frames
            place = f" in {ours[0][0]} {ours[0][1].rpartition('/')[2]}" if ours else ""
            return Verdict("sanitizer", found[1] + place, without_numbers(found[1]) + place)
        errors = [line for line in out.splitlines() if line.startswith("ERROR")]
        if "terminate called" in both or "what():" in both:
            what = re.search(r"what\(\): *(.*)|terminate called.*", both)
            return Verdict("exception", what[0], without_numbers(what[0]))
        if code == "late" or code in (-signal.SIGXCPU, 128 + signal.SIGXCPU) or "signal 24" in err:
            return Verdict("hang", "no end", "")
        crash = re.search(r"exited on signal (\d+)|Signal code|Signal: (.*)", err)
        if (isinstance(code, int) and code < 0) or (code and crash and not errors):
            number = -code if code < 0 else (crash[1] or crash[2] or "")
            return Verdict("crash", f"signal {number}")
        if code:
            return self.read_error(errors, both, code, path)
        if errors:
            return Verdict("no code", errors[0], without_numbers(errors[0]))
        return self.read_numbers(path)

    def read_error(self, errors, both, code, path):
        if not errors:
            lines = [line for line in both.splitlines() if line.strip()]
            last = lines[-1] if lines else ""
            return Verdict("no message", f"code {code}, last line: {last}", without_numbers(last))
        if len({without_rank(e) for e in errors}) > 1:
            return Verdict("many errors", " | ".join(errors[:3]), without_numbers(errors[0]))
        message = errors[0]
        ours = re.search(r"\((?:\S*/)?(DCM/\S+):\d+\)", message)
        if ours and not NAMED.search(message):
            return Verdict("no context", message, without_numbers(message))
        if re.search(r"std::|basic_string|bad_alloc|vector::|Unknown exception|Eigen", message):
            return Verdict("exception", message, without_numbers(message))
        if not ours and re.search(r"Non-numeric|Bond atoms? .*missing|Lost atoms", message):
            # LAMMPS' own; but the package should have been the first to see it
            return Verdict("late error", message, without_numbers(message))
        return self.files_whole(path, True) or Verdict("refused", message, without_numbers(message))

    def read_numbers(self, path):
        rows = thermo(path)
        for line in rows:
            if any(w in ("nan", "-nan", "inf", "-inf") for w in line):
                return Verdict("not a number", "thermo " + " ".join(line), "thermo")
        last = path / "last.dump"
        if last.exists() and re.search(r"\b(nan|inf)\b", last.read_text(errors="replace")):
            return Verdict("not a number", "positions, velocities or forces of the last step")
        return self.files_whole(path) or Verdict("ran")

    def files_whole(self, path, refused=False):
        """Rest files have their last line, logs whole lines; else what a refusal left is broken."""
        for file in path.glob("*.part"):
            return Verdict("file left", file.name)
        for file in [*path.glob("new*.rest")]:
            text = file.read_text(errors="replace")
            if not text.endswith("\n") or "checksum" not in text.splitlines()[-1]:
                return Verdict("damaged file", file.name, "rest")
        if refused and not thermo(path):
            for name in GUARDED:
                if (path / name).exists() and (path / name).read_bytes() != KEEP:
                    return Verdict("damaged file", f"{name} of an earlier run is lost", name)
        return None

    # --- ranks ----------------------------------------------------------------------------------

    def other_ranks(self, case, verdict, mine):
        np = 2 + case.seed % (self.np_max - 1)
        path = self.folder / "ranks"
        code, out, err = self.start(case, path, np)
        other = self.read(code, out, err, path)
        if other.kind == "refused" and LIMIT.search(other.message):
            return verdict
        if other.kind != "ran":
            how = f"{np} ranks: {other.kind} {other.message}"
            return Verdict("ranks differ", how, without_numbers(other.message))
        theirs = thermo(path)
        if len(mine) != len(theirs):
            return Verdict("ranks differ", f"{np} ranks: {len(theirs)} lines for {len(mine)}", "")
        for a, b in zip(mine, theirs):
            for k, (x, y) in enumerate(zip(a, b)):
                if not alike(x, y):
                    text = f"{np} ranks: step {a[0]} column {k}: {x} and {y}"
                    return Verdict("ranks differ", text, f"column {k}")
        return verdict


def without_rank(line):
    return re.sub(r"^ERROR on proc \d+", "ERROR", line)


def alike(x, y):
    a, b = float(x), float(y)
    return a == b or abs(a - b) <= 1e-6 * max(abs(a), abs(b)) + 1e-8


def thermo(path):
    """Words of the thermo lines of all runs."""
    log, rows, width = path / "log.lammps", [], 0
    if not log.exists():
        return rows
    for line in log.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            width = len(words)
        elif line.startswith("Loop time"):
            width = 0
        elif width and len(words) == width and re.fullmatch(r"\d+", words[0]):
            with contextlib.suppress(ValueError):
                _ = [float(w) for w in words]
                rows.append(words)
    return rows
