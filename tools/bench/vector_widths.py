#!/usr/bin/env python3
"""Lavapipe with vectors of 128, 256 and 512 bits (LP_NATIVE_VECTOR_WIDTH), against its default; prints a table.

tools/bench/vector_widths.py [--widths 128,256,512] [--side 256] [--rounds 5] [--frames 4] [--scenes NAME,...]

Each width has a shader cache of its own: Mesa's cache does not distinguish widths, so that with a shared one every run
would use the code compiled first. Widths are measured in turns. Figures are processor seconds of all threads, which
hold on a busy machine too: those of several frames less those of one, which include loading and compiling.
The environment variable SHVR names the program; without it, that of build/release.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHVR = os.environ.get("SHVR", str(ROOT / "build/release/shvr"))

FLAT = [[60, 0, "#405060"], [160, 0.08, "#c0a080"]]
SOFT = [[38, 0, "#405060"], [120, 0.06, "#c0a080"], [255, 0.2, "#ffffff"]]
HARD = [[50, 0, "#405060"], [58, 1, "#c0a080"], [255, 1, "#ffffff"]]
SCENES = {"fog, unshaded": ("fog", FLAT, False), "fog, shaded": ("fog", FLAT, True),
          "tubes, translucent": ("tubes", SOFT, True), "tubes, opaque": ("tubes", HARD, True)}


def write_session(folder, name, side):
    volume, points, is_shaded = SCENES[name]
    session = {"shvr_session": 1, "volume": {"procedural": volume, "size": [side] * 3, "seed": 7},
               "transfer_function": {"points": [dict(zip(("intensity", "opacity", "color"), point)) for point in points]},
               "light": {"shaded": is_shaded}, "render": {"size": [side, side], "step_voxels": 0.5}}
    path = folder / (re.sub(r"\W+", "_", name) + ".session.json")
    path.write_text(json.dumps(session))
    return path


def run(arguments, environment):
    """Returns the processor seconds of the program and its output."""
    with tempfile.TemporaryFile() as output:
        child = subprocess.Popen([SHVR, *map(str, arguments)], env=environment, stdout=output, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = status
        if status != 0:
            sys.exit(f"tools/bench/vector_widths.py: shvr {arguments[0]} failed; expected exit status 0")
        output.seek(0)
        return used.ru_utime + used.ru_stime, output.read().decode()


def environment_of(width, folder):
    environment = {name: value for name, value in os.environ.items() if name != "LP_NATIVE_VECTOR_WIDTH"}
    cache = folder / f"cache-{width or 'default'}"
    cache.mkdir(exist_ok=True)
    environment |= {"MESA_SHADER_CACHE_DIR": str(cache), "XDG_CACHE_HOME": str(cache)}
    return environment | ({"LP_NATIVE_VECTOR_WIDTH": width} if width else {})


def driver_of(environment):
    lines = run(["doctor"], environment)[1].splitlines()
    found = [re.sub(r"\s+", " ", line.split("driver ")[1]) for line in lines if " driver " in line]
    name = [re.sub(r"^ *0 \(in use\) *", "", line) for line in lines if "(in use)" in line]
    return f"{found[0] if found else 'unknown driver'}; {name[0] if name else 'unknown device'}"


def measure(scene, widths, options, folder):
    """Returns, for each width, seconds of a frame in each round, and whether the picture has the default's bits."""
    session = write_session(folder, scene, options.side)
    environments = {width: environment_of(width, folder) for width in widths}
    pictures = {}
    for width, environment in environments.items():
        picture = folder / f"{width or 'default'}.pfm"
        run(["render", session, "-o", picture], environment)
        pictures[width] = picture.read_bytes()
    seconds = {width: [] for width in widths}
    for number in range(options.rounds):
        for width in widths if number % 2 == 0 else reversed(widths):
            profile = ["profile", session, "--warmup", 0, "--json", "--frames"]
            one, _ = run([*profile, 1], environments[width])
            many, _ = run([*profile, 1 + options.frames], environments[width])
            seconds[width].append((many - one) / options.frames)
    return {width: (seconds[width], pictures[width] == pictures[""]) for width in widths}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--widths", default="128,256,512")
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--frames", type=int, default=4)
    parser.add_argument("--scenes", default=",".join(name.replace(",", "") for name in SCENES))
    options = parser.parse_args()
    by_word = {name.replace(",", ""): name for name in SCENES}
    unknown = [word for word in options.scenes.split(",") if word not in by_word]
    if unknown:
        parser.error(f"--scenes: found {unknown[0]!r}, expected of {', '.join(by_word)}")
    widths = ["", *options.widths.split(",")]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"{driver_of(environment_of('', folder))}\n")
        print("| scene | default, CPU ms | " + " | ".join(f"{width} bits" for width in widths[1:]) + " | bits |")
        print("|" + "---|" * (len(widths) + 2))
        for scene in (by_word[word] for word in options.scenes.split(",")):
            found = measure(scene, widths, options, folder)
            base = found[""][0]
            ratios = [statistics.median(a / b for a, b in zip(found[width][0], base)) for width in widths[1:]]
            differs = [width for width in widths[1:] if not found[width][1]]
            print(f"| {scene} | {1000 * statistics.median(base):.0f} | " +
                  " | ".join(f"{ratio:.2f}" for ratio in ratios) +
                  f" | {'differ: ' + ' '.join(differs) if differs else 'equal'} |", flush=True)


if __name__ == "__main__":
    main()
