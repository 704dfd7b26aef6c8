"""Pictures of linear radiance: OpenEXR in and out, PNG for the eye.

A picture is an array (height, width, 4) of float32: radiance in W/(m² sr), linear Rec. 709, premultiplied by the
coverage in the fourth channel.
"""

from __future__ import annotations

from pathlib import Path

from packages import need

np = need("numpy")
OpenEXR = need("OpenEXR")


def read(path: Path | str) -> np.ndarray:
    """Reads R, G, B and A of the first part of an EXR file, or an NPY file; without A, coverage is 1."""
    path = Path(path)
    if not path.is_file():
        raise SystemExit(f"{path} is not there")
    if path.suffix == ".npy":
        picture = np.load(path).astype(np.float32)
    else:
        # Channels one by one: files hold layers beside the picture, and mixed depths.
        channels = OpenEXR.File(str(path), separate_channels=True).parts[0].channels
        missing = [name for name in "RGB" if name not in channels]
        if missing:
            raise SystemExit(f"{path} has no channel {', '.join(missing)}; it has {', '.join(channels)}")
        planes = [channels[name].pixels for name in "RGBA" if name in channels]
        picture = np.stack([np.asarray(plane, dtype=np.float32) for plane in planes], axis=-1)
    if picture.ndim != 3 or picture.shape[2] not in (3, 4):
        raise SystemExit(f"{path} has shape {picture.shape}; wanted height x width x 3 or 4")
    if picture.shape[2] == 3:
        picture = np.concatenate([picture, np.ones_like(picture[..., :1])], axis=-1)
    return picture


def write(path: Path | str, picture: np.ndarray) -> None:
    """Writes 32-bit floats, ZIP (lossless)."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = np.ascontiguousarray(picture, dtype=np.float32)
    if path.suffix == ".npy":
        np.save(path, picture)
        return
    names = "RGBA"[: picture.shape[2]]
    channels = {name: np.ascontiguousarray(picture[..., i]) for i, name in enumerate(names)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, channels).write(str(path))


def write_png(path: Path | str, picture: np.ndarray, exposure: float = 1.0) -> None:
    """Writes sRGB, clipped, for looking at only."""
    imsave = need("matplotlib.image").imsave
    linear = np.clip(picture[..., :3] * exposure, 0.0, 1.0)
    # IEC 61966-2-1.
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    imsave(str(path), encoded)
