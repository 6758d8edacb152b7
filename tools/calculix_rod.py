#!/usr/bin/python3
"""The rod of verification case (a) in CalculiX (Debian package calculix-ccx): ten end loads, same mesh, same elements.

usage: calculix_rod.py [--verify build/release/coxa_verify] [--out verify/calculix_rod.csv] [--work DIR]

Writes P L^2/EI, tip angle in degrees, x / L, w / L, as coxa_verify prints its own.
"""
import argparse
import math
import pathlib
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LENGTH, SIDE, MODULUS = 100.0, 1.0, 1000.0
LOADS = [0.1, 0.25, 0.5, 1, 2, 3, 4, 5, 7.5, 10]


def nodes_of(deck):
    nodes, reading = {}, False
    for line in deck.splitlines():
        if line.startswith("*"):
            reading = line.startswith("*NODE") and not line.startswith("*NODE ")
        elif reading:
            number, *place = line.split(",")
            nodes[int(number)] = tuple(float(value) for value in place)
    return nodes


def node_set(name, numbers):
    return f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for n in numbers)


def steps(tip):
    stiffness = MODULUS * SIDE**4 / 12.0
    for load in LOADS:
        share = -load * stiffness / LENGTH**2 / len(tip)
        forces = "".join(f"{n}, 3, {share:.12g}\n" for n in tip)
        yield f"*STEP, NLGEOM, INC=1000\n*STATIC\n0.2, 1.0\n*CLOAD, OP=NEW\n{forces}*NODE PRINT, NSET=tip, FREQUENCY=1000\nU\n*END STEP\n"


def displacements(printed):
    """Of the last increment of each step: {node: (ux, uy, uz)}, in order."""
    blocks = {}
    time_now = None
    for line in printed.splitlines():
        if "displacements" in line:
            time_now = float(line.split()[-1])
            blocks[time_now] = {}
        elif line.strip() and time_now is not None:
            number, *values = line.split()
            blocks[time_now][int(number)] = tuple(float(v) for v in values)
    return [blocks[t] for t in sorted(blocks) if abs(t - round(t)) < 1e-6]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--verify", default=ROOT / "build/release/coxa_verify")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "verify/calculix_rod.csv")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/coxa_rod"))
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    mesh = options.work / "mesh.inp"
    subprocess.run([str(options.verify), "--rod-mesh", str(mesh)], check=True)
    deck = mesh.read_text()
    nodes = nodes_of(deck)
    clamped = [n for n, place in nodes.items() if place[0] < 1e-9]
    tip = [n for n, place in nodes.items() if place[0] > LENGTH - 1e-9]
    deck += node_set("clamped", clamped) + node_set("tip", tip)
    deck += f"*MATERIAL, NAME=rod\n*ELASTIC\n{MODULUS}, 0.0\n*SOLID SECTION, ELSET=volume, MATERIAL=rod\n"
    deck += "*BOUNDARY\nclamped, 1, 3\n" + "".join(steps(tip))
    (options.work / "rod.inp").write_text(deck)
    start = time.time()
    done = subprocess.run(["ccx", "rod"], cwd=options.work, capture_output=True, text=True)
    found = displacements((options.work / "rod.dat").read_text())
    if len(found) != len(LOADS):
        raise SystemExit(f"CalculiX reached {len(found)} of {len(LOADS)} loads:\n{done.stdout[-500:]}")

    def at(y, z):
        return next(n for n in tip if abs(nodes[n][1] - y) + abs(nodes[n][2] - z) < 1e-9)

    lines = ['load,"tip angle, degrees",x / L,w / L']
    for load, u in zip(LOADS, found):
        place = {n: [nodes[n][c] + u[n][c] for c in range(3)] for n in tip}
        centre, low, high = place[at(0.5, 0.5)], place[at(0.5, 0.0)], place[at(0.5, 1.0)]
        angle = math.degrees(math.atan2(high[0] - low[0], high[2] - low[2]))
        lines.append(f"{load},{angle:.6g},{centre[0] / LENGTH:.6g},{(0.5 * SIDE - centre[2]) / LENGTH:.6g}")
    options.out.write_text("\n".join(lines) + "\n")
    print("\n".join(lines), f"\n{time.time() - start:.1f} s")


if __name__ == "__main__":
    main()
