"""Mean FLIP of the pictures of cutis-render/src/difference/flip/tests.rs by the authors' own program.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install flip-evaluator==1.7
    /tmp/venv/bin/python validation/flip_reference.py

Prints for each pair of pictures the mean and the largest error, and for HDR the exposures, as they stand in that test.
"""

import flip_evaluator
import numpy as np

WIDTH, HEIGHT = 96, 64
Y, X, C = np.meshgrid(np.arange(HEIGHT), np.arange(WIDTH), np.arange(3), indexing="ij")


def noise(seed, x=X, y=Y, c=C):
    """Even noise in 0..1 from a hash of 32 bits."""
    u = lambda v: np.asarray(v).astype(np.uint32)
    h = (u(x) * u(0x9E3779B1)) ^ (u(y) * u(0x85EBCA77)) ^ (u(c) * u(0xC2B2AE3D)) ^ u(seed)
    h = (h ^ (h >> u(15))) * u(0x2C1B3C6D)
    h = (h ^ (h >> u(12))) * u(0x297A2D39)
    h = h ^ (h >> u(15))
    return (h >> u(8)).astype(np.float64) / 2.0**24


def gradient():
    across, down = X / (WIDTH - 1), Y / (HEIGHT - 1)
    return np.choose(C, [across, down, 0.5 * (1 - across)])


def disc(centre):
    inside = (X - centre) ** 2 + (Y - 31.5) ** 2 < 400
    return np.where(inside, np.choose(C, [0.8, 0.5, 0.4]), 0.05)


def blocks(turn):
    return noise(7, X // 8, Y // 8, (C + turn) % 3)


def ramp():
    return 2.0 ** (10 * X / (WIDTH - 1) - 5) * np.choose(C, [1.0, 0.6, 0.3])


def sparks(height):
    return 0.02 + 0.01 * noise(3) + np.where((X % 16 == 8) & (Y % 16 == 8), height, 0)


def lit_corner(height):
    return np.where((X < 40) & (Y < 40), height * gradient(), 0)


LDR = {
    "gradient, paler": (gradient() * 0.9 + 0.05, gradient()),
    "gradient, noisy": (np.clip(gradient() + 0.2 * (noise(1) - 0.5), 0, 1), gradient()),
    "disc, shifted": (disc(50), disc(47)),
    "blocks, other hues": (blocks(1), blocks(0)),
    "white and black": (np.ones_like(gradient()), np.zeros_like(gradient())),
}
HDR = {
    "ramp, noisy": (ramp() * (1 + 0.3 * (noise(2) - 0.5)), ramp()),
    "sparks, lost": (sparks(0), sparks(200)),
    "sparks, dimmer": (sparks(100), sparks(200)),
    "disc, brighter": (disc(47) * 20, disc(47) * 16),
    "lit corner": (lit_corner(4) + 0.001, lit_corner(5) + 0.002),
    "corner in black": (lit_corner(4), lit_corner(5)),
}


def evaluate(pairs, kind, ppd):
    for name, (test, reference) in pairs.items():
        test, reference = (np.ascontiguousarray(p, dtype=np.float32) for p in (test, reference))
        errors, mean, used = flip_evaluator.evaluate(
            reference, test, kind, inputsRGB=False, applyMagma=False, parameters={"ppd": ppd}
        )
        exposures = ""
        if kind == "HDR":
            exposures = f", {used['startExposure']:.6f} to {used['stopExposure']:.6f} EV in {used['numExposures']}"
        print(f"{kind} {ppd} {name}: mean {errors.mean(dtype=np.float64):.7f} max {errors.max():.6f}{exposures}")


if __name__ == "__main__":
    for ppd in (67.0, 20.0):
        evaluate(LDR, "LDR", ppd)
        evaluate(HDR, "HDR", ppd)
