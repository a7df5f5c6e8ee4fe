#!/usr/bin/env python3
"""Operations on groups, SHVR and scipy, scikit-image or VTK in turns (tools/peers/editor.py); writes EDITOR.md.

tools/bench/editor.py [--side 512] [--rounds 3] [--only NAME,...] [--page F.md] [--results F.json] [--rewrite]

Each operation runs in a process of its own, SHVR and its peers alternately, on the bundles of the phantom `stem`.
Results are kept in a JSON file: operations that are left out by --only stay as they were measured before, at their own
size. The environment names the programs: SHVR and OPERATION_BENCH; without it, those of build/release.
"""
import argparse
import fcntl
import json
import os
import platform
import statistics
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHVR = Path(os.environ.get("SHVR", ROOT / "build/release/shvr"))
BENCH = Path(os.environ.get("OPERATION_BENCH", SHVR.parent / "shvr_operation_bench"))
PEER = ROOT / "tools/peers/editor.py"
PYTHON = "/usr/bin/python3"  # Debian's, which has the peers
BUDGET_MIB = 4096
COUNTERS = ("bricks_read", "bricks_written", "bricks_of_intensities")

# What `agree` may be: the most voxels, per million, in which the results may differ; or how other results are compared.
ROUNDED = 200  # weights of another precision; another rule for ties
# Name, line of a script, mask, peers, agreement, and what differs.
OPERATIONS = {
    "combine": ({"op": "combine", "group": 1, "with": 2, "how": "add"}, "both", ["numpy_combine"], 0,
                "SHVR also records what every voxel was, to undo it"),
    "threshold": ({"op": "threshold", "group": 1, "from": 120}, "bundles", ["numpy_threshold"], 0,
                  "SHVR also records what every voxel was, to undo it, and asks a source for intensities, brick by brick"),
    "grow": ({"op": "grow", "group": 1, "distance": 3}, "bundles", ["scipy_distances_grow", "scipy_ball_grow"], 0, ""),
    "shrink": ({"op": "shrink", "group": 1, "distance": "thin"}, "bundles", ["scipy_distances_shrink", "scipy_ball_shrink"],
               0, "the ball of scipy is no sphere where voxels are anisotropic"),
    "open": ({"op": "open", "group": 1, "distance": "thin"}, "bundles", ["scipy_distances_open"], 0, ""),
    "close": ({"op": "close", "group": 1, "distance": 3}, "bundles", ["scipy_distances_close"], 0, ""),
    "hollow": ({"op": "hollow", "group": 1, "wall": "thin"}, "bundles", ["scipy_distances_hollow"], 0, ""),
    "median": ({"op": "smooth", "method": "median", "distance": 3}, "bundles", ["scipy_median", "skimage_majority"],
               ROUNDED, "the peers treat the volume's border differently"),
    "gaussian": ({"op": "smooth", "method": "gaussian", "distance": 3}, "bundles", ["scipy_gaussian"], ROUNDED,
                 "the peer has float32 weights, and another border; SHVR's are whole numbers, so that all groups are "
                 "compared exactly in any order"),
    "fill_holes": ({"op": "fill_holes", "group": 1}, "holes", ["scipy_label_holes", "scipy_fill_holes"], 0, ""),
    "islands": ({"op": "islands", "group": 1, "keep": "largest"}, "specks", ["scipy_largest", "skimage_largest"], 0,
                ""),
    "fill_between": ({"op": "fill_between", "group": 1, "axis": "z"}, "slices", ["scipy_slices"], 0, ""),
    "grow_seeds": ({"op": "grow_seeds", "on": "intensity", "box": "whole"}, "seeds", ["skimage_watershed"], 30000,
                   "voxels of equal cost go to either group"),
    "lasso": ({"op": "lasso", "camera": "front", "polygon": "triangle", "side": "inside"}, "both", ["skimage_polygon"],
              ROUNDED, "the peer tests one slice and repeats it: it has no other views; SHVR projects parts of 8^3 voxels, "
              "and single ones along the polygon, and records what every voxel was"),
    "trace_from_mask": ({"op": "trace_from_mask", "group": 1}, "bundles", ["skimage_skeleton"], "parts",
                        "the peer ends with thinned voxels: no graph, no radii"),
    "mask_from_trace": ({"op": "mask_from_trace", "group": 3}, "bundles", [], 0, "none of the three has it"),
    "surfaces": ({"op": "surfaces", "smooth": 20}, "both", ["vtk_surfaces"], "triangles",
                 "the peer's borders are not shared, and volumes not kept; SHVR keeps the volumes of all groups within "
                 "0.5 %, by repeated measuring. Tried: sums of neighbours without loops, and no middles of faces where "
                 "none is needed; both together took 1.43 instead of 1.48 processor seconds and were left out. Most of "
                 "the time, faces are put together again, for each measuring of volumes and for each group"),
}


def output_of(arguments):
    ran = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(f"tools/bench/editor.py: {' '.join(map(str, arguments[:3]))}: {ran.stderr.strip()[-2000:]}")
    return json.loads(ran.stdout)


def expect_peers():
    found = subprocess.run([PYTHON, "-c", "import scipy, skimage, vtk"], capture_output=True, check=False)
    if found.returncode != 0:
        sys.exit(f"tools/bench/editor.py: {PYTHON} lacks a peer; expected Debian's python3-scipy, python3-skimage and "
                 "python3-vtk9")


def inputs(side, folder):
    """The folder with the phantom and the masks made of it."""
    folder = folder / f"editor{side}"
    if not (folder / "seeds.raw").exists():
        folder.mkdir(parents=True, exist_ok=True)
        output_of([SHVR, "phantom", "stem", "--size", side, "--seed", 1, "-o", folder, "--quiet", "--json"])
        output_of([PYTHON, PEER, "prepare", folder, side])
    return folder


def line_of(name, side):
    line = dict(OPERATIONS[name][0])
    for key in ("distance", "wall"):
        if line.get(key) == "thin":
            line[key] = 2 if side >= 256 else 1
    if line.get("box") == "whole":
        line["box"] = [0, 0, 0, side, side, side]
    if line.get("polygon") == "triangle":
        line["polygon"] = [[0.13 * side, 0.21 * side], [0.87 * side, 0.32 * side], [0.44 * side, 0.83 * side]]
    return json.dumps(line)


def agreement(name, ours, theirs, files):
    """Voxels that differ, or both counts; and whether that is as expected."""
    rule = OPERATIONS[name][3]
    if isinstance(rule, str):
        a, b = ours[rule], theirs[rule]
        return f"{a} and {b} {rule}", a == b if rule == "parts" else 0.5 < a / b < 2
    differ = output_of([PYTHON, PEER, "differ", *files])["differ"]
    return ("equal" if differ == 0 else f"{differ} voxels differ",
            1e6 * differ <= rule * files[0].stat().st_size)


def hold(folder):
    """Returns a lock: two runs in one folder would overwrite each other's results. It ends with the program."""
    folder.mkdir(parents=True, exist_ok=True)
    lock = open(folder / "editor.lock", "w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"tools/bench/editor.py: {folder} is used by another run; expected another --folder, or its end")
    return lock


def measure(name, side, rounds, folder):
    """The runs of one operation, with medians, and the peer that took the least processor time."""
    _, mask, peers, _, _ = OPERATIONS[name]
    place = inputs(side, folder)
    files = [place / "ours.raw", place / "theirs.raw"]
    runs = {program: [] for program in ["shvr", *peers]}
    agreed = {}
    for _ in range(rounds):
        ours = output_of([BENCH, line_of(name, side), side, place / f"{mask}.raw", place / "stem.raw", BUDGET_MIB,
                          files[0]])
        runs["shvr"].append(ours)
        for peer in peers:
            theirs = output_of([PYTHON, PEER, "run", peer, side, place / f"{mask}.raw", place / "stem.raw", files[1]])
            runs[peer].append(theirs)
            if peer not in agreed:
                agreed[peer], is_right = agreement(name, ours, theirs, files)
                if not is_right:
                    sys.exit(f"tools/bench/editor.py: {name}: SHVR and {peer} do not agree: {agreed[peer]}")
    for file in files:
        file.unlink(missing_ok=True)

    def median(program, key):
        return statistics.median(run[key] for run in runs[program])
    found = {"side": side, "rounds": rounds, "mask": mask, "build": ours.get("build", ""), "programs": {
        program: {key: median(program, key) for key in ("seconds", "cpu_seconds", "peak_bytes")} for program in runs}}
    for peer in peers:
        for key in ("seconds", "cpu_seconds"):
            found["programs"][peer][f"{key}_ratio"] = statistics.median(
                ours[key] / theirs[key] for ours, theirs in zip(runs["shvr"], runs[peer]))
        found["programs"][peer]["agreed"] = agreed[peer]
    found["counters"] = {key: ours[key] for key in (*COUNTERS, "voxels", "nodes", "triangles") if ours.get(key)}
    return found


HEAD = """# Measured: operations on groups

`tools/bench/editor.py` writes this page: each operation of
[engine/annotation/operations](../../engine/annotation/operations/README.md), and the surfaces of
[engine/annotation/meshes](../../engine/annotation/meshes/README.md), against the same operation of numpy, scipy,
scikit-image or VTK ([tools/peers](../peers/README.md)), in turns, each in a process of its own, on the bundles of the
phantom `stem`. Medians; ratios are those of pairs of runs, SHVR over the peer: below 1, SHVR is faster. Ratios of
processor time hold on a busy machine, too, those of time are disturbed by it. Reading is not timed; changing the mask
is. Times never gate. `cli/bench_editor` checks at a small size that results agree, and the counts of bricks.

"""


# Measured once, in pairs, before and after a change; kept as text, since the older program is gone.
HISTORY = """Processor seconds of SHVR before and after operations went by words of bits, runs and parts of bricks (256^3, the
phantom `stem`, -O2, loaded machine, medians of pairs; results equal bit by bit):

| operation | before | after | ratio |
|---|---|---|---|
| combine | 0.0340 | 0.0133 | 0.39 |
| threshold | 0.0633 | 0.0316 | 0.50 |
| shrink | 0.601 | 0.0090 | 0.015 |
| hollow | 0.601 | 0.0068 | 0.011 |
| gaussian | 0.636 | 0.197 | 0.31 |
| lasso | 0.0221 | 0.0168 | 0.76 |
| trace_from_mask | 4.85 | 0.297 | 0.061 |
"""


def rounded(value):
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def page_of(results):
    lines = ["| operation | side | peer | SHVR s | peer s | ratio | SHVR processor s | peer processor s | ratio | results |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for name in (name for name in OPERATIONS if name in results):
        programs = results[name]["programs"]
        ours = programs["shvr"]
        for peer, theirs in [(p, t) for p, t in programs.items() if p != "shvr"] or [(None, None)]:
            if peer is None:
                lines.append(f"| {name} | {results[name]['side']} | none | {rounded(ours['seconds'])} | | | "
                             f"{rounded(ours['cpu_seconds'])} | | | |")
                continue
            numbers = [rounded(ours["seconds"]), rounded(theirs["seconds"]), rounded(theirs["seconds_ratio"]),
                       rounded(ours["cpu_seconds"]), rounded(theirs["cpu_seconds"]),
                       rounded(theirs["cpu_seconds_ratio"])]
            lines.append(f"| {name} | {results[name]['side']} | {peer.replace('_', ' ')} | {' | '.join(numbers)} | "
                         f"{theirs['agreed']} |")
    lines += ["", f"Memory above what the inputs take, against the budget of {BUDGET_MIB} MiB; and work, which is the same "
              "in every run.", "", "| operation | side | SHVR MiB | peers MiB | bricks read | written | of intensities | "
              "voxels, nodes or triangles |", "|---|---|---|---|---|---|---|---|"]
    for name in (name for name in OPERATIONS if name in results):
        programs, counters = results[name]["programs"], results[name]["counters"]
        peaks = [f"{t['peak_bytes'] / 2**20:.0f}" for p, t in programs.items() if p != "shvr"]
        changed = counters.get("triangles") or counters.get("nodes") or counters.get("voxels", 0)
        lines.append(f"| {name} | {results[name]['side']} | {programs['shvr']['peak_bytes'] / 2**20:.0f} | "
                     f"{', '.join(peaks)} | " + " | ".join(str(counters.get(key, 0)) for key in COUNTERS) +
                     f" | {changed} |")
    notes = ["\n".join(textwrap.wrap(f"- `{name}`: {OPERATIONS[name][4]}.", 120, subsequent_indent="  ",
                                     break_on_hyphens=False))
             for name in OPERATIONS if name in results and OPERATIONS[name][4]]
    machine = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                    if line.startswith("model name")), platform.machine())
    return (HEAD + "\n".join(lines) + "\n\nWhere the programs differ, and why SHVR is slower where it is:\n\n" +
            "\n".join(notes) + f"\n\n{HISTORY}\nMachine: {machine}, {os.cpu_count()} threads, with other work on them. SHVR's build: "
            f"{', '.join(sorted({result['build'] for result in results.values()}))}. Rounds: "
            f"{', '.join(sorted({str(result['rounds']) for result in results.values()}))}.\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--side", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="")
    parser.add_argument("--folder", type=Path, default=ROOT / "build/bench")
    parser.add_argument("--results", type=Path, default=ROOT / "tools/bench/editor.json")
    parser.add_argument("--rewrite", action="store_true", help="measures nothing; writes the page of the results again")
    parser.add_argument("--page", type=Path, default=ROOT / "tools/bench/EDITOR.md")
    arguments = parser.parse_args()
    names = [name for name in arguments.only.split(",") if name] or list(OPERATIONS)
    if unknown := [name for name in names if name not in OPERATIONS]:
        sys.exit(f"tools/bench/editor.py: --only names {unknown[0]}; expected some of: {', '.join(OPERATIONS)}")
    if not arguments.rewrite:
        expect_peers()
    results = json.loads(arguments.results.read_text()) if arguments.results.exists() else {}
    if arguments.rewrite:
        arguments.page.write_text(page_of(results))
        return
    lock = hold(arguments.folder)
    for name in names:
        results[name] = measure(name, arguments.side, arguments.rounds, arguments.folder)
        print(f"{name}: " + ", ".join(f"{program} {run['seconds']:.2f} s" for program, run in
                                      results[name]["programs"].items()), flush=True)
        arguments.results.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n")
        arguments.page.write_text(page_of(results))
    lock.close()


if __name__ == "__main__":
    main()
