#!/usr/bin/python3
"""A hip pressed by a prescribed way in CalculiX (Debian package calculix-ccx), beside coxa on the same meshes.

usage: calculix_hip.py JOINT.toml [--press build/release/joint_press] [--way 0.7] [--along X Y Z] [--stiffness 100]
                       [--flexion DEG] [--rotation DEG] [--withdraw MM] [--ten-node] [--ours JOINT.toml] [--threads 1] [--work DIR]

The deck is the meshes that joint_press writes as .inp, with the socket's bone side held, the head's bone side moved, E 12 MPa
and Poisson's ratio 0.42, frictionless surface-to-surface penalty contact, large deformations.  Default direction: against the
opening axis of libhip m2 left.  Force from reactions, area as CalculiX prints it; pressures and centre of pressure from the overlaps at the slave's
integration points, each with its part of what of its face is in contact, as coxa samples its own.

With --ours coxa takes the meshes and the law of that file, CalculiX those of the first: meshes on which both are as accurate.  The last line
is the ratio of their processor times, reading and printing included.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
AXIS_M2_LEFT = [-0.72366, 0.33958, 0.60083]


def parse(deck):
    """Nodes, elements and surfaces of one mesh as coxa writes it."""
    nodes, elements, surfaces, current = {}, {}, {}, None
    kind = ""
    for line in deck.splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            fields = dict(f.strip().split("=") for f in line.split(",")[1:] if "=" in f)
            if line.startswith("*NODE"):
                current = "node"
            elif line.startswith("*ELEMENT"):
                current, kind = "element", fields["TYPE"]
            elif line.startswith("*SURFACE"):
                current = surfaces.setdefault(fields["NAME"], [])
            else:
                current = None
        elif current == "node":
            number, *place = line.split(",")
            nodes[int(number)] = [float(v) for v in place]
        elif current == "element":
            number, *corners = line.split(",")
            elements[int(number)] = [int(v) for v in corners]
        elif isinstance(current, list):
            element, side = line.split(",")
            current.append((int(element), int(side.strip()[1:])))
    return nodes, elements, surfaces, kind


# corners, then mid nodes, of the sides S1 to S4 of a tetrahedron
SIDES = {1: (0, 1, 2, 4, 5, 6), 2: (0, 3, 1, 7, 8, 4), 3: (1, 3, 2, 8, 9, 5), 4: (2, 3, 0, 9, 7, 6)}


def side_nodes(elements, side):
    element = elements[side[0]]
    return [element[k] for k in SIDES[side[1]] if k < len(element)]


def wrapped(numbers):
    return "".join(", ".join(map(str, numbers[k:k + 12])) + ",\n" for k in range(0, len(numbers), 12))


def write_deck(path, meshes, move, stiffness):
    """One deck of both meshes; the head's numbers follow the socket's."""
    text, offset_node, offset_element = "", 0, 0
    for name, (nodes, elements, surfaces, kind) in meshes.items():
        text += "*NODE\n" + "".join(f"{n + offset_node}, {p[0]:.15g}, {p[1]:.15g}, {p[2]:.15g}\n" for n, p in nodes.items())
        text += f"*ELEMENT, TYPE={kind}, ELSET={name}\n"
        for number, corners in elements.items():
            text += f"{number + offset_element}, " + ", ".join(str(c + offset_node) for c in corners) + "\n"
        bone = sorted({n + offset_node for s in surfaces["bone_side"] for n in side_nodes(elements, s)})
        text += f"*NSET, NSET={name}_bone\n" + wrapped(bone)
        text += f"*NSET, NSET={name}_all\n" + wrapped(sorted(n + offset_node for n in nodes))
        text += f"*SURFACE, NAME={name}_side, TYPE=ELEMENT\n"
        text += "".join(f"{e + offset_element}, S{s}\n" for e, s in surfaces["articular_side"])
        text += f"*SOLID SECTION, ELSET={name}, MATERIAL=cartilage\n"
        offset_node += max(nodes)
        offset_element += max(elements)
    text += "*MATERIAL, NAME=cartilage\n*ELASTIC\n12.0, 0.42\n"
    text += f"*SURFACE INTERACTION, NAME=sliding\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{stiffness}\n"
    text += "*CONTACT PAIR, INTERACTION=sliding, TYPE=SURFACE TO SURFACE\nsocket_side, head_side\n"
    text += "*BOUNDARY\nsocket_bone, 1, 3\n*STEP, NLGEOM, INC=200\n*STATIC\n0.25, 1.0\n*BOUNDARY\n"
    text += "".join(f"head_bone, {c + 1}, {c + 1}, {move[c]:.12g}\n" for c in range(3))
    text += "*NODE PRINT, NSET=socket_bone, TOTALS=ONLY, FREQUENCY=1000\nRF\n"
    text += "*NODE PRINT, NSET=socket_all, FREQUENCY=1000\nU\n"
    text += "*CONTACT PRINT, FREQUENCY=1000\nCDIS\n*CONTACT PRINT, SLAVE=socket_side, MASTER=head_side, FREQUENCY=1000\nCF\n*END STEP\n"
    path.write_text(text)


def sections(printed):
    """The blocks of numbers of a .dat file, under their headings, of the last increment."""
    found, heading = {}, ""
    for line in printed.splitlines():
        words = line.split()
        if not words:
            continue
        try:
            found.setdefault(heading, []).append([float(w) for w in words])
        except ValueError:
            heading = line.strip()
            found[heading] = []
    return found


def section(found, word):
    return next(rows for heading, rows in found.items() if word in heading)


def percentile(values, areas, share):
    order = np.argsort(values)
    below = np.cumsum(areas[order])
    return values[order][np.searchsorted(below, share * below[-1])]


def shares_in_contact(counts, areas, in_contact):
    """The share of each face that is in contact, from how many of its points are.  CalculiX prints the points that press only, not how
    many a face has: taken as the number for all faces with which the shares add up to the area that it prints."""
    low, high = 1.0, 10.0 * counts.max()
    for _ in range(60):
        full = 0.5 * (low + high)
        low, high = (full, high) if (areas * np.minimum(1.0, counts / full)).sum() > in_contact else (low, full)
    return np.minimum(1.0, counts / full)


def figures(printed, meshes, stiffness):
    found = sections(printed)
    force = np.array(section(found, "total force (fx,fy,fz) for set SOCKET_BONE")[0])
    moved = {int(r[0]): np.array(r[1:4]) for r in section(found, "displacements")}
    area = section(found, "area,  normal force")[0][0]
    nodes, elements, surfaces, _ = meshes["socket"]
    overlaps = {}
    for row in section(found, "relative contact displacement"):
        overlaps.setdefault((int(row[0]), int(row[1])), []).append(max(0.0, -row[2]))
    pressures, areas, places = [], [], []
    for side, values in overlaps.items():
        a, b, c = (np.array(nodes[n]) + moved[n] for n in side_nodes(elements, side)[:3])
        pressures.append(stiffness * np.array(values))
        areas.append(0.5 * np.linalg.norm(np.cross(b - a, c - a)))
        places.append((a + b + c) / 3.0)
    areas = np.array(areas) * shares_in_contact(np.array([len(p) for p in pressures]), np.array(areas), area)
    point_areas = np.concatenate([np.full(len(p), a / len(p)) for p, a in zip(pressures, areas)])
    points = np.concatenate(pressures)
    means = np.array([np.mean(p) for p in pressures])
    centre = (np.array(places) * (means * areas)[:, None]).sum(axis=0) / (means * areas).sum()
    return (f"force {np.linalg.norm(force):.1f} N ({force[0]:.1f} {force[1]:.1f} {force[2]:.1f}), area {area:.1f} mm2, "
            f"p95 {percentile(points, point_areas, 0.95):.3f}, p99 {percentile(points, point_areas, 0.99):.3f} MPa, "
            f"centre of pressure {centre[0]:.2f} {centre[1]:.2f} {centre[2]:.2f}")


def processor_time():
    """Of the programs that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def pressed(options, along, joint, *more):
    """What joint_press prints, and the processor time it takes."""
    start = processor_time()
    done = subprocess.run([str(options.press), joint, "--way", str(options.way), "--along", *map(str, along), "--flexion", str(options.flexion),
                           "--rotation", str(options.rotation), "--withdraw", str(options.withdraw), *more],
                          check=True, capture_output=True, text=True)
    return done.stdout, processor_time() - start


def run_calculix(work, threads):
    """Its elapsed and its processor time, s."""
    start, used = time.time(), processor_time()
    done = subprocess.run(["ccx", "hip"], cwd=work, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": str(threads)})
    (work / "hip.log").write_text(done.stdout + done.stderr)
    elapsed, used = time.time() - start, processor_time() - used
    print(f"CalculiX: {elapsed:.0f} s elapsed, {used:.0f} s of processor, ended with {done.returncode}")
    return used


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("joint")
    parser.add_argument("--press", default=ROOT / "build/release/joint_press")
    parser.add_argument("--way", type=float, default=0.7)
    parser.add_argument("--along", type=float, nargs=3, default=AXIS_M2_LEFT)
    parser.add_argument("--flexion", type=float, default=0.0, help="the head is turned so first, degrees")
    parser.add_argument("--rotation", type=float, default=0.0, help="internal, degrees")
    parser.add_argument("--withdraw", type=float, default=0.0, help="and moved back by so much, mm: the way starts there")
    parser.add_argument("--stiffness", type=float, default=100.0)
    parser.add_argument("--ten-node", action="store_true")
    parser.add_argument("--ours", help="joint file for coxa, where its meshes are not the deck's")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/coxa_hip"))
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    along = np.array(options.along) / np.linalg.norm(options.along)
    text, ours = pressed(options, along, options.joint, "--decks", str(options.work), *["--ten-node"] * options.ten_node)
    if options.ours:
        text, ours = pressed(options, along, options.ours)
    print("coxa:", text, end="")
    meshes = {"socket": parse((options.work / "acetabular.inp").read_text()),
              "head": parse((options.work / "femoral.inp").read_text())}
    print("deck:", " + ".join(f"{len(mesh[1])} elements, {len(mesh[0])} nodes" for mesh in meshes.values()))
    write_deck(options.work / "hip.inp", meshes, options.way * along, options.stiffness)
    theirs = run_calculix(options.work, options.threads)
    print("CalculiX:", figures((options.work / "hip.dat").read_text(), meshes, options.stiffness))
    print(f"processor time: CalculiX {theirs:.1f} s, coxa {ours:.2f} s, ratio {theirs / ours:.0f}")


if __name__ == "__main__":
    main()
