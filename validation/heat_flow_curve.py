"""Draw error against time of heat flow and of the separable blur, from the table of their bench.

    cargo bench -p cutis-bench --bench heat_flow -- table 2>&1 | python validation/heat_flow_curve.py docs/images/heat_flow_curve.png

One panel for the processor, without and with the time that links take in a pose and in a first frame, and one for the adapter. Numbers at the points
are sides of the maps, texels.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from packages import need

COLUMNS = ("links_s", "pose_s", "light_s", "adapter_s", "error_percent", "near_seams_percent")


def rows_of(lines: list[str]) -> list[dict]:
    """Rows of the bench's table; other lines are left out."""
    rows = []
    for line in lines:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 3 + len(COLUMNS) or not cells[1].endswith("²") or not cells[1][:-1].isdigit():
            continue
        numbers = dict(zip(COLUMNS, map(float, cells[3:])))
        rows.append({"operator": cells[0], "texels": int(cells[1][:-1]), **numbers})
    return rows


def plot(rows: list[dict], path: Path) -> None:
    need("matplotlib").use("Agg")
    pyplot = need("matplotlib.pyplot")

    curves = {
        "processor": [
            ("separable", "separable", lambda row: row["light_s"], "o-"),
            ("heat flow", "heat-flow", lambda row: row["light_s"], "s-"),
            ("heat flow in a new pose", "heat-flow", lambda row: row["light_s"] + row["pose_s"], "s--"),
            ("heat flow, first frame", "heat-flow", lambda row: row["light_s"] + row["links_s"], "s:"),
        ],
        "adapter": [
            ("separable", "separable", lambda row: row["adapter_s"], "o-"),
            ("heat flow", "heat-flow", lambda row: row["adapter_s"], "s-"),
        ],
    }
    figure, panels = pyplot.subplots(1, 2, figsize=(10.0, 4.5), sharey=True)
    for axes, (machine, lines) in zip(panels, curves.items()):
        for label, operator, time_s, style in lines:
            own = [row for row in rows if row["operator"] == operator]
            x, y = [time_s(row) for row in own], [row["error_percent"] for row in own]
            axes.loglog(x, y, style, label=label)
            place = (4, 4) if operator == "separable" else (-4, -10)
            for row, px, py in zip(own, x, y):
                axes.annotate(str(row["texels"]), (px, py), textcoords="offset points", xytext=place, fontsize=7)
        axes.set_xlabel(f"time on the {machine} [s]")
        axes.grid(True, which="both", alpha=0.3)
        axes.legend(fontsize=8)
    panels[0].set_yticks([2, 3, 4, 5], ["2", "3", "4", "5"], minor=False)
    panels[0].set_yticks([], minor=True)
    panels[0].set_ylabel("error of three Gaussians, RMS [% of the mean]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture", type=Path, help="where the plot goes: .png")
    arguments = parser.parse_args()
    rows = rows_of(sys.stdin.readlines())
    if {row["operator"] for row in rows} != {"separable", "heat-flow"}:
        print("error: no table of the bench heat_flow on stdin; see --help", file=sys.stderr)
        return 2
    plot(rows, arguments.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
