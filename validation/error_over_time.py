#!/usr/bin/env python3
"""Error of a picture over the time it takes. Runs programs at several sample counts, takes from their reports the time of the
render itself (without the start of the program and without files), compares each picture with a converged reference, and
writes a table (CSV) and a plot (PNG).

A run is PROGRAM:SAMPLES[,SAMPLES...][@REFERENCE], for example cutis:truth:1,4,16,64 or cycles:walk:16,64@cycles_4096.exr.
Programs: cutis:TECHNIQUE, mitsuba:rough|smooth|matched, cycles:walk|skin|volume, eevee:walk.
A program that draws another model (cycles:walk, any diffusion technique) never reaches the reference of another one: give
it its own with @, or read its curve's floor as the difference of the models.

Error: relative root mean square over the pixels that picture and reference cover in full and over R, G, B, of
(x - r) / (r + 0.01 mean r), without the largest 0.1 % of the squares, so that single fireflies don't hide what the
rest does. 0.01 mean r keeps dark pixels from ruling; the mean is that of the reference over the mask."""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pictures
import regions
from packages import need

np = need("numpy")

HERE = Path(__file__).resolve().parent
TRIMMED = 1e-3
DARK = 0.01


@dataclass(frozen=True)
class Run:
    """One program and way, its sample counts, and what it is compared with."""

    program: str
    way: str
    samples: list[int]
    reference: Path


def main() -> int:
    arguments = parse()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for run in arguments.runs:
        reference = pictures.read(run.reference)
        for samples in run.samples:
            rows.append(measure(run, samples, reference, arguments))
            print(as_line(rows[-1]), file=sys.stderr, flush=True)
    table = arguments.output.with_suffix(".csv")
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    plot(rows, arguments.output.with_suffix(".png"))
    print("\n".join(as_line(row) for row in rows))
    print(f"{table} and {arguments.output.with_suffix('.png')}")
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path, help="scene file, such as target/validation/head_environment.toml")
    parser.add_argument("--reference", type=Path, help="converged picture that runs without @ are compared with")
    parser.add_argument(
        "--run",
        dest="run_texts",
        action="append",
        required=True,
        metavar="RUN",
        help="see above; may be given several times",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("target/validation/error_over_time"),
        help="name of the table and the plot, without ending [default target/validation/error_over_time]",
    )
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path("target/validation/error_over_time_pictures"),
        help="where the pictures go [default target/validation/error_over_time_pictures]",
    )
    parser.add_argument(
        "--seed", type=int, default=101, help="seed of the runs; the reference must have others [default 101]"
    )
    parser.add_argument(
        "--cutis",
        default=os.environ.get("CUTIS", "target/release/cutis"),
        help="cutis program [default $CUTIS, else target/release/cutis]",
    )
    parser.add_argument(
        "--cutis-option",
        action="append",
        default=[],
        metavar="TEXT",
        help="further option for cutis, such as --cutis-option=--threads=1; may be given several times",
    )
    parser.add_argument("--timeout", type=float, default=600.0, help="longest a run may take [s, default 600]")
    arguments = parser.parse_args()
    arguments.runs = [parse_run(parser, text, arguments.reference) for text in arguments.run_texts]
    if not arguments.scene.is_file():
        parser.error(f"{arguments.scene} is not there; `python validation/prepare.py` makes the scenes")
    return arguments


def parse_run(parser: argparse.ArgumentParser, text: str, reference: Path | None) -> Run:
    what, _, own = text.partition("@")
    parts = what.split(":")
    if len(parts) != 3 or parts[0] not in COMMANDS:
        parser.error(
            f"--run {text}: must be PROGRAM:WAY:SAMPLES[,SAMPLES][@REFERENCE], program one of {', '.join(COMMANDS)}"
        )
    try:
        samples = [int(n) for n in parts[2].split(",")]
    except ValueError:
        parser.error(f"--run {text}: samples must be whole numbers")
    chosen = Path(own) if own else reference
    if chosen is None:
        parser.error(f"--run {text}: has no reference; give --reference or @FILE")
    if not chosen.is_file():
        parser.error(f"--run {text}: the reference {chosen} is not there")
    return Run(parts[0], parts[1], samples, chosen)


def cutis_command(run: Run, samples: int, size: str, picture: Path, arguments: argparse.Namespace) -> list[str]:
    return [
        arguments.cutis, "render", str(arguments.scene), "--technique", run.way, "--samples", str(samples), "--size", size,
        "--seed", str(arguments.seed), "--bits", "32", "-o", str(picture), "--json", *arguments.cutis_option,
    ]  # fmt: skip


def mitsuba_command(run: Run, samples: int, size: str, picture: Path, arguments: argparse.Namespace) -> list[str]:
    return [
        sys.executable, str(HERE / "mitsuba_scene.py"), str(arguments.scene), "--interface", run.way, "--samples", str(samples),
        "--seeds", "1", "--size", size, "--seed", str(arguments.seed), "-o", str(picture), "--json", "--warm-up",
    ]  # fmt: skip


def cycles_command(run: Run, samples: int, size: str, picture: Path, arguments: argparse.Namespace) -> list[str]:
    return [
        sys.executable, str(HERE / "cycles_scene.py"), str(arguments.scene), "--model", run.way, "--samples", str(samples),
        "--size", size, "--seed", str(arguments.seed), "-o", str(picture), "--json",
    ]  # fmt: skip


def eevee_command(run: Run, samples: int, size: str, picture: Path, arguments: argparse.Namespace) -> list[str]:
    with_display = [] if os.environ.get("DISPLAY") else ["xvfb-run", "-a"]
    return [*with_display, *cycles_command(run, samples, size, picture, arguments), "--engine", "eevee"]


COMMANDS = {"cutis": cutis_command, "mitsuba": mitsuba_command, "cycles": cycles_command, "eevee": eevee_command}


def measure(run: Run, samples: int, reference: np.ndarray, arguments: argparse.Namespace) -> dict:
    """Runs once; the row of the table."""
    height, width = reference.shape[:2]
    picture = arguments.folder / f"{run.program}_{run.way}_{samples}.exr"
    command = COMMANDS[run.program](run, samples, f"{width}x{height}", picture, arguments)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=arguments.timeout)
    except FileNotFoundError as error:
        raise SystemExit(f"{command[0]} is not there; for cutis: cargo build --release, or --cutis") from error
    except subprocess.TimeoutExpired as error:
        raise SystemExit(
            f"{' '.join(command)} took more than {arguments.timeout:.0f} s; take fewer samples or --timeout"
        ) from error
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with status {done.returncode}:\n{done.stderr.strip()}")
    report = json.loads(done.stdout.strip().splitlines()[-1] if run.program != "cutis" else done.stdout)
    drawn = pictures.read(picture)
    return {
        "program": run.program,
        "way": run.way,
        "samples": report["samples_per_pixel"],
        "render_seconds": round(render_seconds(report), 4),
        "relative_rmse": round(relative_rmse(drawn, reference), 6),
        # All pixels together: a bias that more samples don't remove.
        "mean_difference": round(mean_difference(drawn, reference), 6),
        "reference": run.reference.name,
    }


def render_seconds(report: dict) -> float:
    """The time without the reading and writing of files: cutis lists them among its passes, the others leave them out.
    Trees and tables of the scene count for cutis and Blender; Mitsuba builds its tree when it reads, which is left out."""
    files = sum(p["milliseconds"] for p in report.get("passes", []) if p["name"] in ("read", "write"))
    return report["wall_seconds"] - 1e-3 * files


def masked(picture: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mask = regions.common_mask([picture, reference])
    if not mask.any():
        raise SystemExit("picture and reference share no covered pixel; do they show the same scene?")
    return picture[mask][:, :3].astype(np.float64), reference[mask][:, :3].astype(np.float64)


def relative_rmse(picture: np.ndarray, reference: np.ndarray) -> float:
    """As the module's doc defines it."""
    x, r = masked(picture, reference)
    squares = np.sort((((x - r) / (r + DARK * r.mean())) ** 2).ravel())
    kept = squares[: max(1, int(len(squares) * (1.0 - TRIMMED)))]
    return float(np.sqrt(kept.mean()))


def mean_difference(picture: np.ndarray, reference: np.ndarray) -> float:
    x, r = masked(picture, reference)
    return float(x.mean() / r.mean() - 1.0)


def as_line(row: dict) -> str:
    return (
        f"{row['program']:8} {row['way']:14} {row['samples']:6} spp {row['render_seconds']:9.3f} s   relative RMSE "
        f"{100 * row['relative_rmse']:8.3f} %   mean {100 * row['mean_difference']:+7.3f} %   against {row['reference']}"
    )


def plot(rows: list[dict], path: Path) -> None:
    need("matplotlib").use("Agg")
    pyplot = need("matplotlib.pyplot")

    figure, axes = pyplot.subplots(figsize=(7.0, 5.0))
    for name in dict.fromkeys((row["program"], row["way"], row["reference"]) for row in rows):
        points = [row for row in rows if (row["program"], row["way"], row["reference"]) == name]
        x, y = [p["render_seconds"] for p in points], [100 * p["relative_rmse"] for p in points]
        axes.loglog(x, y, marker="o", label=f"{name[0]} {name[1]} against {name[2]}")
        for point, px, py in zip(points, x, y):
            axes.annotate(str(point["samples"]), (px, py), textcoords="offset points", xytext=(4, 4), fontsize=7)
    axes.set_xlabel("render time [s], samples per pixel at the points")
    axes.set_ylabel("relative RMSE, largest 0.1 % left out [%]")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    sys.exit(main())
