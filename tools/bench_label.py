#!/usr/bin/env python3
"""Labelling of whole volumes, SHVR and a peer in turns (tools/peers/README.md).

tools/bench_label.py [--rounds 7] [--with scipy|cc3d]

Both read a file of bytes and label what is at or above a threshold, joined over faces. `label` is until labels are known (SHVR
keeps them as runs in a temporary file, the peer as an array), `to file` until an array of them is safe on the disk. Medians in
milliseconds, with SHVR's time over the peer's. The environment names the program: SHVR; without it, that of build/release.
"""
import argparse
import json
import os
import random
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build/bench"
SHVR = Path(os.environ.get("SHVR", ROOT / "build/release/shvr"))
PEER = ROOT / "tools/peers/label.py"

# Name, side, and threshold of each volume. Noise is uniform over all 256 values, so the threshold sets the share.
VOLUMES = [("noise, 30 %", 256, 179), ("noise, 50 %", 256, 128), ("tubes", 256, 128), ("noise, 30 %", 512, 179),
           ("tubes", 512, 128)]


def output_of(arguments):
    ran = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(f"tools/bench_label.py: {ran.stderr.strip()}")
    return json.loads(ran.stdout)


def python_with(module):
    """An interpreter that has the module: this one, or Debian's own."""
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", f"import numpy, {module}"], stderr=subprocess.DEVNULL, check=False).returncode == 0:
            return python
    return sys.exit(f"tools/bench_label.py: no Python with numpy and {module}")


def volume(name, side):
    kind = name.split(",")[0]
    path = FOLDER / f"{kind}{side}" / f"{kind}.raw"
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        return path
    if kind == "noise":
        path.write_bytes(random.Random(1).randbytes(side ** 3))
    else:
        output_of([SHVR, "phantom", kind, "--size", side, "--seed", 1, "-o", path.parent, "--quiet", "--json"])
    return path


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--with", dest="program", choices=("scipy", "cc3d"), default="scipy")
    arguments = parser.parse_args()
    python = python_with(arguments.program)
    print(f"| volume | components | SHVR label | {arguments.program} label | ratio | SHVR to file | {arguments.program} to file "
          "| ratio |\n|---|---|---|---|---|---|---|---|")
    for name, side, threshold in VOLUMES:
        raw = volume(name, side)
        ours, theirs = [], []
        for _ in range(arguments.rounds):
            ours.append(output_of([SHVR, "label", raw, "--raw", f"{side}x{side}x{side}:uint8", "--threshold", threshold,
                                   "-o", FOLDER / "labels.nrrd", "--json", "--quiet"]))
            theirs.append(output_of([python, PEER, raw, side, threshold, "--with", arguments.program,
                                     "-o", FOLDER / "labels.raw"]))
        counts = {run["components"] for run in ours + theirs}
        if len(counts) != 1:
            sys.exit(f"tools/bench_label.py: {name}: the programs do not agree on the components: {sorted(counts)}")
        row = f"| {name}, {side}^3 | {counts.pop()} |"
        for key in ("label_seconds", "seconds"):
            a, b = (1000 * statistics.median(run[key] for run in runs) for runs in (ours, theirs))
            row += f" {a:.0f} | {b:.0f} | {a / b:.2f} |"
        print(row, flush=True)


if __name__ == "__main__":
    main()
