"""Runs: one per scene and settings, each in a folder of its own, and what came of it in
`result.json` beside it. What has a result is not run again, unless its deck has changed."""
import functools
import hashlib
import json
import os
import subprocess
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from study import clock

from .scenes import SCENES, failure


@dataclass(frozen=True)
class Point:
    """A run: scene and what differs from the scene's defaults (sorted pairs)."""

    scene: str
    changes: tuple

    @classmethod
    def of(cls, scene, **changes):
        """The point, without changes that change nothing."""
        known = SCENES[scene].settings({})
        SCENES[scene].settings(changes)
        return cls(scene, tuple(sorted((k, str(v)) for k, v in changes.items()
                                       if known[k] != str(v))))

    @property
    def name(self):
        """Name of the folder."""
        text = ",".join(f"{k}={v}" for k, v in self.changes) or "default"
        return text.replace(" ", "_").replace("/", "_")


@functools.cache
def digest(point):
    """Of all that is run for a point, but not of the program: text."""
    scene = SCENES[point.scene]
    with tempfile.TemporaryDirectory() as place:
        words = scene.write(Path(place), scene.settings(dict(point.changes)))
        sums = hashlib.sha256("\0".join(words).encode())
        for file in sorted(Path(place).iterdir()):
            sums.update(file.read_bytes())
    return sums.hexdigest()[:16]


@dataclass
class Result:
    """values: see scenes; seconds: user CPU time of the run; steps; note: why it failed; deck:
    digest of what was run."""

    values: dict = field(default_factory=dict)
    seconds: float = float("nan")
    steps: int = 0
    note: str = ""
    deck: str = ""


class Runner:
    """Runs points, `jobs` at a time, below `folder`."""

    def __init__(self, folder, lmp, jobs=1, longest=1800.0, say=print):
        self.folder, self.lmp, self.jobs = Path(folder), lmp, jobs
        self.longest, self.say = longest, say
        self.lock = threading.Lock()
        self.stopping = False
        self.children = set()

    def place(self, point):
        return self.folder / "points" / point.scene / point.name

    def result(self, point):
        """Result of a point, None if it has not been run, or with another deck."""
        path = self.place(point) / "result.json"
        found = Result(**json.loads(path.read_text())) if path.exists() else None
        return found if found and found.deck == digest(point) else None

    def run(self, point):
        """Run one point and keep its result."""
        scene, folder = SCENES[point.scene], self.place(point)
        folder.mkdir(parents=True, exist_ok=True)
        words = ["nice", "-n", "5", *self.lmp, "-in", "in.run", "-nocite",
                 *scene.write(folder, scene.settings(dict(point.changes)))]
        with open(folder / "out", "w", encoding="utf-8") as out:
            child = subprocess.Popen(words, cwd=folder, stdout=out, stderr=subprocess.STDOUT)
        self.children.add(child)
        status, usage = self.wait(child)
        self.children.discard(child)
        if self.stopping:
            return
        result = Result(seconds=usage.ru_utime, deck=digest(point))
        log = folder / "log.lammps"
        if log.exists():
            loops = [line.split() for line in log.read_text(errors="replace").splitlines()
                     if line.startswith("Loop time")]
            result.steps = sum(int(words[8]) for words in loops)
        if status is None:
            result.note = f"more than {clock(self.longest)} of CPU time"
        elif status:
            result.note = failure(folder)
        else:
            result.values = scene.read(folder)
        part = folder / "result.json.part"
        part.write_text(json.dumps(result.__dict__))
        part.rename(folder / "result.json")

    def wait(self, child):
        """Status (None: took too long) and resource usage of a child, once it has ended."""
        begun, late = time.time(), False
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                child.returncode = os.waitstatus_to_exitcode(status)
                return None if late else child.returncode, usage
            if self.stopping or time.time() - begun > 4.0 * self.longest:
                late = True
                child.terminate()
            time.sleep(0.02)

    def run_all(self, points):
        """Run what has no result yet, the least work first; prints progress and time left. Returns
        how many runs that were."""
        todo = [p for p in dict.fromkeys(points) if self.result(p) is None]
        weight = {p: SCENES[p.scene].weight(dict(p.changes)) for p in todo}
        every, behind, begun = sum(weight.values()), 0.0, time.time()
        number = len(todo)
        if todo:
            self.say(f"[accuracy] {number} runs to do, {self.jobs} at a time; load "
                     f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        order = list(SCENES)

        def one(point):
            nonlocal behind
            if self.stopping:
                return
            self.run(point)
            if self.stopping:
                return
            with self.lock:
                behind += weight.pop(point)
                left = (time.time() - begun) * (every - behind) / behind
                result = self.result(point)
                self.say(f"[accuracy {time.strftime('%H:%M')}] {number - len(weight)} of {number}: "
                         f"{point.scene} {point.name} {result.seconds:.1f} s"
                         f"{' FAILED: ' + result.note if result.note else ''}; time left: "
                         f"{clock(left)}")

        with ThreadPoolExecutor(self.jobs) as pool:
            waiting = [pool.submit(one, p) for p in
                       sorted(todo, key=lambda p: (order.index(p.scene), weight[p]))]
            try:
                for task in waiting:
                    task.result()
            except BaseException:
                self.stopping = True
                raise
        return number
