"""Prints cutis-render/src/difference/magma.rs: the colour map "magma" of matplotlib, 256 sRGB colours.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install matplotlib
    /tmp/venv/bin/python validation/magma_table.py > cutis-render/src/difference/magma.rs
"""

import matplotlib

colours = matplotlib.colormaps["magma"](range(256))
codes = ["0x" + "".join(f"{round(255 * c):02x}" for c in colour[:3]) for colour in colours]

print(f"""//! The colour map "magma" as sRGB codes 0xrrggbb, from 0 to 1 in even steps.
//!
//! Source: matplotlib {matplotlib.__version__}, `_cm_listed.py`, by S. van der Walt and N. Smith; CC0.
//! Made by `validation/magma_table.py`.

/// 256 colours.
#[rustfmt::skip]
pub(super) const MAGMA: [u32; 256] = [""")
for start in range(0, 256, 8):
    print("    " + ", ".join(codes[start : start + 8]) + ",")
print("];")
