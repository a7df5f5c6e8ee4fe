#!/usr/bin/env python3
"""Stands in for a hand: writes the strokes, nodes or stylus positions of a person who follows the veins of a phantom.

    hand.py paint TRACE --group G --threshold T --radius R     strokes, as lines of `shvr annotate --script`
    hand.py florets TRACE --section G --threshold T            strokes through the florets above their veins
    hand.py trace TRACE --group G --radius R                   nodes and internodes, as such lines
    hand.py stylus TRACE --chain N                             a recording for the action `follow_stylus`
    hand.py specks TRACE --size N --group G --threshold T      one stroke of the speckle brush all over the volume
    hand.py box --crop X,Y,Z --to X,Y,Z --size N               not a hand: the edges of a box, as surfaces
    hand.py mask RAW --size N --crop X,Y,Z --to X,Y,Z          not a hand: a true mask, cropped and downscaled

TRACE is the GraphML file of `shvr phantom`. A real scan has no such file: there a person does the same in the window,
and `shvr view --log FILE` writes it down. Strokes follow each chain of the section, from branch to branch. Positions
are those of the phantom, less --crop, divided by --shrink, as `shvr import` was told to crop and to downscale. With
--to, the upper corner of the crop, strokes end at its faces, and nodes outside it are left out.

Where a scan is darker towards its axis z, a person lowers the paint threshold there: with --on-axis it changes from
--threshold at the faces of the scan, of --size voxels a side, to that value on the axis, by the square of the distance.
"""

import argparse
import importlib.machinery
import json
import pathlib
import sys
import xml.etree.ElementTree


def read(path):
    """(nodes {id: (place, group)}, links [(id, id, group)]) of a phantom's trace; places in voxels."""
    root = xml.etree.ElementTree.parse(path).getroot()
    names = {key.get("id"): key.get("attr.name") for key in root.iterfind(".//{*}key")}
    nodes = {}
    for node in root.iterfind(".//{*}node"):
        values = {names[data.get("key")]: data.text for data in node.iterfind("{*}data")}
        nodes[node.get("id")] = (tuple(float(values[axis]) for axis in "xyz"), int(values["group"]))
    links = [(edge.get("source"), edge.get("target")) for edge in root.iterfind(".//{*}edge")]
    return nodes, links


def chains(links):
    """Node ids along each segment: between nodes with one link or more than two."""
    beside = {}
    for a, b in links:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    done, found = set(), []
    for start in beside:
        if len(beside[start]) == 2:
            continue
        for following in beside[start]:
            chain = [start, following]
            while len(beside[chain[-1]]) == 2:
                chain.append(next(n for n in beside[chain[-1]] if n != chain[-2]))
            if (chain[-1], chain[-2]) not in done:
                done.add((chain[0], chain[1]))
                found.append(chain)
    return found


def runs_inside(chain, nodes, lower, upper):
    """The parts of a chain whose nodes lie inside the crop: a person places none outside the volume."""
    runs = [[]]
    for node in chain:
        if all(low <= at <= high for low, at, high in zip(lower, nodes[node][0], upper)):
            runs[-1].append(node)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if len(run) > 1]


def inside(a, b, lower, upper):
    """The part of the straight line from a to b in a box, as its two ends, or None."""
    first, last = 0.0, 1.0
    for p, q, low, high in zip(a, b, lower, upper):
        if p == q:
            if not low <= p <= high:
                return None
            continue
        enters, leaves = sorted(((low - p) / (q - p), (high - p) / (q - p)))
        first, last = max(first, enters), min(last, leaves)
    if first > last:
        return None
    return [b if t == 1.0 else tuple(p + t * (q - p) for p, q in zip(a, b)) for t in (first, last)]


def threshold_at(place, options):
    """Of a place in the scan, which is darker towards its axis."""
    if options.on_axis is None:
        return options.threshold
    middle = options.size / 2
    away = min(1.0, sum((place[axis] - middle) ** 2 for axis in (0, 1)) / middle ** 2)
    return round(options.on_axis + away * (options.threshold - options.on_axis), 1)


def stroke(places, group, options):
    """One stroke, of places in the scan, or several where the threshold changes on the way."""
    pieces = [places] if options.on_axis is None else [places[i:i + 2] for i in range(len(places) - 1)]
    for piece in pieces:
        middle = [sum(axis) / len(piece) for axis in zip(*piece)]
        print(json.dumps({"op": "paint", "brush": options.brush, "region": "ball", "group": group,
                          "threshold": threshold_at(middle, options), "radius": options.radius,
                          "only_unpainted": options.only_unpainted,
                          "path": [options.place(place) for place in piece]}))


def paint(nodes, found, options):
    for chain in found:
        # A vein's chain may end at a node of another section; the vein then belongs to that section's group.
        group = next(each for each in (options.group, options.section, nodes[chain[-1]][1]) if each is not None)
        places, runs = [nodes[node][0] for node in chain], []
        for a, b in zip(places, places[1:]):
            part = inside(a, b, options.crop, options.upper) if options.to else [a, b]
            if part and runs and runs[-1][-1] == part[0]:
                runs[-1].append(part[1])
            elif part:
                runs.append(part)
        for run in runs:
            stroke(run, group, options)


def florets(nodes, links, options):
    """A stroke through each floret: from --from to --up voxels of the scan above the upper end of its vein."""
    beside = {}
    for a, b in links:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    for node, others in beside.items():
        x, y, z = nodes[node][0]
        if nodes[node][1] != options.section or len(others) != 1 or nodes[others[0]][0][2] >= z:
            continue
        if part := inside((x, y, z + options.low), (x, y, z + options.high), options.crop, options.upper):
            stroke(part, nodes[node][1], options)


def trace(nodes, found, options):
    """A node at each place; at a branch the person selects the node that is there, and goes on from it."""
    placed = {}
    for chain in found:
        print('{"op":"deselect"}')
        for i, node in enumerate(chain):
            if node not in placed:
                placed[node] = options.first_node + len(placed)
                print(json.dumps({"op": "node", "at": options.place(nodes[node][0]), "radius": options.radius,
                                  "group": nodes[node][1] if options.group is None else options.group}))
            else:
                print(json.dumps({"op": "link" if i else "select", "node": placed[node]}))
                if i:
                    print(json.dumps({"op": "select", "node": placed[node]}))


def stylus(nodes, found, options):
    """The hand of tools/make_stylus_path, which strays by 1.5 mm, along one chain."""
    tool = pathlib.Path(__file__).resolve().parents[2] / "tools" / "make_stylus_path"
    loader = importlib.machinery.SourceFileLoader("make_stylus_path", str(tool))
    module = type(importlib)("make_stylus_path")
    loader.exec_module(module)
    line = [options.place(nodes[node][0]) for node in found[0]]
    print("\n".join(module.trace(f"chain {options.chain}", "um", [options.spacing] * 3, line)))


def specks(options):
    """Positions half a radius apart would take minutes in a large volume: each one is a diameter from the next."""
    side, apart = int(options.size / options.shrink), int(2 * options.radius)
    steps = range(0, side + apart, apart)
    path = [[x, y, z] for z in steps for y in steps for x in steps]
    print(json.dumps({"op": "paint", "brush": "speckle", "region": "box", "group": options.group,
                      "threshold": options.threshold, "radius": options.radius, "only_unpainted": True, "path": path}))


def box(options):
    """A rod along each of the twelve edges."""
    ends = (options.crop, options.upper)
    corners = [[ends[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    rods = [{"from": corners[i], "to": corners[i | 1 << axis], "radius": options.size / 160, "color": "#203060"}
            for i in range(8) for axis in range(3) if not i >> axis & 1]
    print(json.dumps(rods))


def write_part(options):
    """The voxels of a mask of --size voxels a side from --crop up to --to, as a bare mask on standard output. With
    --shrink N each is the most frequent of N^3, if at least half of them are in a group."""
    voxels, side, step = pathlib.Path(options.file).read_bytes(), options.size, int(options.shrink)
    lower, upper = options.crop, options.upper
    for z in range(lower[2], upper[2], step):
        for y in range(lower[1], upper[1], step):
            rows = [voxels[begin + lower[0]:begin + upper[0]] for begin in
                    ((side * (z + k // step) + y + k % step) * side for k in range(step * step))]
            if not any(map(any, rows)):
                sys.stdout.buffer.write(bytes((upper[0] - lower[0]) // step))
                continue
            for x in range(0, upper[0] - lower[0], step):
                block = b"".join(row[x:x + step] for row in rows)
                groups = [group for group in block if group]
                is_structure = 2 * len(groups) >= len(block)
                sys.stdout.buffer.write(bytes([max(set(groups), key=groups.count) if is_structure else 0]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("what", choices=("paint", "florets", "trace", "stylus", "specks", "mask", "box"))
    parser.add_argument("file", nargs="?")
    parser.add_argument("--crop", default="0,0,0")
    parser.add_argument("--shrink", type=float, default=1.0)
    parser.add_argument("--section", type=int, help="the group of the chains in TRACE; all without it")
    parser.add_argument("--group", type=int, help="to paint or trace with; the section's own without it")
    parser.add_argument("--threshold", type=float, default=110)
    parser.add_argument("--on-axis", type=float, help="the threshold on the scan's axis")
    parser.add_argument("--only-unpainted", action="store_true", help="take no voxel from another group")
    parser.add_argument("--from", type=float, default=0, dest="low", help="of florets: where strokes begin")
    parser.add_argument("--up", type=float, default=0, dest="high", help="of florets: where strokes end")
    parser.add_argument("--radius", type=float, default=3)
    parser.add_argument("--brush", default="flood")
    parser.add_argument("--first-node", type=int, default=0)
    parser.add_argument("--chain", type=int, help="only this one")
    parser.add_argument("--chains", type=int, help="only so many")
    parser.add_argument("--skip", type=int, default=1, help="take each N-th node of a chain, and its ends")
    parser.add_argument("--spacing", type=float, default=1.0, help="of the project, in micrometres")
    parser.add_argument("--size", type=int)
    parser.add_argument("--to")
    options = parser.parse_args()
    options.crop = [int(x) for x in options.crop.split(",")]
    options.upper = [int(x) for x in options.to.split(",")] if options.to else [1e9] * 3
    if options.what in ("mask", "specks", "box"):
        {"mask": write_part, "specks": specks, "box": box}[options.what](options)
        return
    options.place = lambda at: [round((p - c) / options.shrink, 3) for p, c in zip(at, options.crop)]
    nodes, links = read(options.file)
    if options.section is not None:
        links = [link for link in links if nodes[link[1]][1] == options.section]
    found = [chain[:-1:options.skip] + chain[-1:] for chain in chains(links)]
    if options.what == "florets":
        florets(nodes, links, options)
        return
    if options.to and options.what != "paint":
        found = [run for chain in found for run in runs_inside(chain, nodes, options.crop, options.upper)]
    found = found[:options.chains] if options.chain is None else found[options.chain:options.chain + 1]
    {"paint": paint, "trace": trace, "stylus": stylus}[options.what](nodes, found, options)


if __name__ == "__main__":
    main()
