"""One picture per scene: error against time of every setting, and where the error of the default
comes from."""
import math

from .scenes import SCENES
from .tables import percent

MARKS = {"time": "o", "solver": "v", "space": "s", "division": "D", "look": "P", "marks": "X",
         "border": "p"}
FLOOR = 1e-6     # relative; smaller errors are drawn there


def draw(map_, path):
    """Write the picture of a scene; nothing if nothing was run."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    shown = [k for k in map_.knobs if k.kind in MARKS and
             any(h.row.relative == h.row.relative for h in map_.heads[k.name])]
    if not shown:
        return False
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.5, 5.2), layout="constrained",
                                            width_ratios=(3, 2))
    colors = dict(zip((k.name for k in shown), pyplot.get_cmap("tab20").colors))
    work(map_, shown, left, colors)
    budget(map_, right, colors)
    figure.legend(*left.get_legend_handles_labels(), fontsize=8, ncols=6,
                  loc="outside lower center")
    figure.suptitle(f"{map_.scene}: {SCENES[map_.scene].about}", fontsize=10)
    figure.savefig(path, dpi=90)
    pyplot.close(figure)
    return True


def work(map_, shown, axes, colors):
    """Error against time, a line a setting, the front of the motion's, the defaults as stars."""
    for knob in shown:
        rows = [h.row for h in map_.heads[knob.name] if h.row.relative == h.row.relative]
        error = [100.0 * max(r.relative, FLOOR) for r in rows]
        color = colors[knob.name]
        line = [(e, r.cost) for r, e in zip(rows, error) if r.x is not None]
        if line:
            axes.plot(*zip(*line), "-", lw=1, color=color)
        for r, e in zip(rows, error):
            unclear = r.relative <= r.uncertain
            axes.plot(e, r.cost, MARKS[knob.kind], color=color, ms=5,
                      mfc="white" if unclear else color)
            if r.default:
                axes.plot(e, r.cost, "*", color=color, ms=13, mec="black", mew=0.6)
            if r.runs > 1:
                axes.plot([100.0 * max(r.low, FLOOR), 100.0 * max(r.high, FLOOR)], [r.cost, r.cost],
                          color=color, lw=6, alpha=0.25, solid_capstyle="butt")
        axes.plot([], [], MARKS[knob.kind] + "-", color=color, ms=5, lw=1, label=knob.name)
    best = [h.row for h in map_.front()]
    axes.plot([100.0 * max(r.relative, FLOOR) for r in best], [r.cost for r in best], "-", lw=7,
              color="0.82", zorder=0, label="front of steps and solver")
    axes.plot([], [], "*", color="white", ms=13, mec="black", mew=0.6, label="default")
    per = "hour of biology" if SCENES[map_.scene].hours else "run"
    axes.set(xscale="log", yscale="log", xlabel="relative error, largest of the quantities (%)",
             ylabel=f"CPU seconds per {per}")
    axes.grid(alpha=0.3)


def budget(map_, axes, colors):
    """Bars: error of each setting at the default, with the band of single orientations."""
    parts = map_.budget()
    labels = []
    for k, head in enumerate(parts):
        row = head.row
        value = 100.0 * max(row.relative, FLOOR)
        axes.barh(k, value, left=FLOOR * 10, color=colors.get(row.knob, "0.5"), alpha=0.8)
        if row.runs > 1:
            axes.plot([100.0 * max(row.low, FLOOR), 100.0 * row.high], [k, k], "k|-", lw=1.2, ms=9)
        axes.text(1.15 * max(value, 100.0 * row.high if row.runs > 1 else 0.0), k,
                  f"{percent(row.relative)} %", va="center", fontsize=8)
        labels.append(f"{row.knob}: {row.label}\n{row.quantity}")
    top = max((100.0 * max(h.row.relative, h.row.high) for h in parts), default=1.0)
    axes.set(xscale="log", xlim=(min([1e-3] + [50.0 * max(h.row.relative, FLOOR) for h in parts]),
                                 8.0 * top if math.isfinite(top) else 100.0),
             xlabel="error at the default (%)")
    axes.set_yticks(range(len(parts)), labels, fontsize=7)
    axes.invert_yaxis()
    axes.set_title(f"half of the largest: {map_.half()}", fontsize=8)
    axes.grid(alpha=0.3, axis="x")
