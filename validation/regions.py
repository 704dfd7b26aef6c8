#!/usr/bin/env python3
"""Compares two pictures by regions: the mean radiance in each of 8 x 8 tiles, over the pixels that both cover. Each side
is one picture or several of independent seeds; from several follows the standard error of each mean. Prints a table and
the largest relative difference."""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import pictures
from packages import need

np = need("numpy")

GRID = 8
FULL_COVERAGE = 0.999  # pixels at outlines mix with the background, by filters that differ
LEAST_COVERED = 0.25  # tiles with less of their area covered have too few pixels to say anything


@dataclass
class Regions:
    """Means over tiles: (tiles, 3), and their standard errors, NaN from a single picture."""

    means: np.ndarray
    standard_errors: np.ndarray
    seeds: int


def main() -> int:
    arguments = parse()
    first, second = ([pictures.read(path) for path in paths] for paths in (arguments.first, arguments.second))
    mask = common_mask(first + second)
    if not mask.any():
        raise SystemExit("no pixel is covered by all pictures")
    kept = tiles_with_enough(mask)
    a, b = of_pictures(first, mask, kept), of_pictures(second, mask, kept)
    report = compare(a, b, mask, kept)
    print(json.dumps(report, indent=2) if arguments.json else as_text(report))
    limit = arguments.fail_above
    return 1 if limit is not None and report["largest_relative_difference"] > limit else 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--first",
        nargs="+",
        type=Path,
        required=True,
        metavar="PICTURE",
        help="EXR or NPY; several seeds of one picture may be given",
    )
    parser.add_argument(
        "--second",
        nargs="+",
        type=Path,
        required=True,
        metavar="PICTURE",
        help="the same of the other program; relative differences are (first - second) / second",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of a table")
    parser.add_argument(
        "--fail-above",
        type=float,
        metavar="FRACTION",
        help="end with status 1 if the largest relative difference is above this [fraction; default: never]",
    )
    return parser.parse_args()


def common_mask(all_pictures: list[np.ndarray]) -> np.ndarray:
    """Pixels that every picture covers in full."""
    shapes = {picture.shape for picture in all_pictures}
    if len(shapes) > 1:
        raise SystemExit(f"pictures differ in size: {sorted(shapes)}")
    return np.logical_and.reduce([picture[..., 3] >= FULL_COVERAGE for picture in all_pictures])


def tile_numbers(shape: tuple[int, int]) -> np.ndarray:
    """Number of the tile in which each pixel lies, row by row from the upper left."""
    rows = np.arange(shape[0]) * GRID // shape[0]
    columns = np.arange(shape[1]) * GRID // shape[1]
    return rows[:, None] * GRID + columns[None, :]


def tiles_with_enough(mask: np.ndarray) -> np.ndarray:
    """Numbers of the tiles that are covered enough to count."""
    covered = np.bincount(tile_numbers(mask.shape)[mask], minlength=GRID * GRID)
    area = np.bincount(tile_numbers(mask.shape).ravel(), minlength=GRID * GRID)
    return np.flatnonzero(covered >= LEAST_COVERED * area)


def tile_means(picture: np.ndarray, mask: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Mean radiance of the masked pixels of each kept tile, (tiles, 3)."""
    numbers = tile_numbers(mask.shape)[mask]
    count = np.bincount(numbers, minlength=GRID * GRID)[kept]
    sums = [
        np.bincount(numbers, weights=picture[..., c][mask].astype(np.float64), minlength=GRID * GRID)[kept]
        for c in range(3)
    ]
    return np.stack(sums, axis=-1) / count[:, None]


def of_pictures(seeds: list[np.ndarray], mask: np.ndarray, kept: np.ndarray) -> Regions:
    """Means over seeds, and from their spread the standard errors."""
    per_seed = np.stack([tile_means(picture, mask, kept) for picture in seeds])
    if len(seeds) == 1:
        return Regions(per_seed[0], np.full_like(per_seed[0], math.nan), 1)
    return Regions(per_seed.mean(axis=0), per_seed.std(axis=0, ddof=1) / math.sqrt(len(seeds)), len(seeds))


def compare(a: Regions, b: Regions, mask: np.ndarray, kept: np.ndarray) -> dict:
    """All tiles, the largest relative difference, and how many standard errors it is where they are known."""
    relative = (a.means - b.means) / np.maximum(b.means, 1e-12)
    error = np.hypot(a.standard_errors, b.standard_errors)
    worst = np.unravel_index(np.abs(relative).argmax(), relative.shape)
    sigmas = np.abs(a.means - b.means) / np.maximum(error, 1e-12)
    count = np.bincount(tile_numbers(mask.shape)[mask], minlength=GRID * GRID)[kept][:, None]
    whole_a, whole_b = ((r.means * count).sum(axis=0) / count.sum() for r in (a, b))
    return {
        "tiles": [
            {
                "row": int(t // GRID),
                "column": int(t % GRID),
                "pixels": int(count[i, 0]),
                "first": a.means[i].tolist(),
                "first_standard_error": number_or_null(a.standard_errors[i]),
                "second": b.means[i].tolist(),
                "second_standard_error": number_or_null(b.standard_errors[i]),
                "relative_difference": relative[i].tolist(),
            }
            for i, t in enumerate(kept)
        ],
        "whole_first": whole_a.tolist(),
        "whole_second": whole_b.tolist(),
        "whole_relative_difference": ((whole_a - whole_b) / whole_b).tolist(),
        "root_mean_square_relative_difference": float(np.sqrt((relative**2).mean())),
        "largest_relative_difference": float(np.abs(relative).max()),
        "largest_is_in": {
            "row": int(kept[worst[0]] // GRID),
            "column": int(kept[worst[0]] % GRID),
            "channel": "RGB"[worst[1]],
        },
        "largest_in_standard_errors": number_or_null(sigmas[worst]),
        "mean_square_in_standard_errors": number_or_null((sigmas**2).mean()),
        "mean_square_expected_of_noise": expected_mean_square(a.seeds + b.seeds - 2),
    }


def expected_mean_square(degrees_of_freedom: int) -> float | None:
    """Mean square of Student's t: a little above 1, since the standard errors are themselves estimates."""
    return degrees_of_freedom / (degrees_of_freedom - 2) if degrees_of_freedom > 2 else None


def number_or_null(value: np.ndarray | float) -> list | float | None:
    """JSON has no NaN."""
    return np.asarray(value).tolist() if np.isfinite(value).all() else None


def as_text(report: dict) -> str:
    lines = [
        "row col  pixels   first R G B             second R G B            difference % R G B       in standard errors"
    ]
    for t in report["tiles"]:
        a, b, d = t["first"], t["second"], t["relative_difference"]
        ea, eb = t["first_standard_error"], t["second_standard_error"]
        sigmas = (
            "-"
            if ea is None or eb is None
            else " ".join(f"{(x - y) / max(math.hypot(e, f), 1e-12):+5.1f}" for x, y, e, f in zip(a, b, ea, eb))
        )
        lines.append(
            f"{t['row']:3} {t['column']:3} {t['pixels']:7}   "
            + " ".join(f"{x:7.5f}" for x in a)
            + "   "
            + " ".join(f"{x:7.5f}" for x in b)
            + "   "
            + " ".join(f"{100 * x:+7.2f}" for x in d)
            + "   "
            + sigmas
        )
    whole = " ".join(f"{100 * x:+.3f}" for x in report["whole_relative_difference"])
    where = report["largest_is_in"]
    lines.append(f"all pixels: difference {whole} %")
    lines.append(
        f"largest relative difference {100 * report['largest_relative_difference']:.2f} % in row {where['row']} column {where['column']} {where['channel']}"
        + (
            ""
            if report["largest_in_standard_errors"] is None
            else f" ({report['largest_in_standard_errors']:.1f} standard errors)"
        )
        + f"; root mean square {100 * report['root_mean_square_relative_difference']:.2f} %"
    )
    if report["mean_square_in_standard_errors"] is not None:
        expected = report["mean_square_expected_of_noise"]
        noise = (
            "too few seeds to say what noise would give" if expected is None else f"noise alone gives {expected:.2f}"
        )
        lines.append(
            f"mean square difference in standard errors {report['mean_square_in_standard_errors']:.2f}; {noise}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
