#!/usr/bin/python3
"""Writes walk.trc: the markers of a made-up walker's pelvis and right thigh over two strides, with soft tissue artefact.

No person: the bones turn as data/movements/gait.toml says, the joint centre lies where Bell's regression puts it for an
inter-ASIS distance of 240 mm, and the skin of the thigh slides along it by up to 12 mm with flexion. Needs numpy.
Usage: examples/make_walk.py examples/walk.trc
"""
import pathlib
import sys
import tomllib

import numpy as np

RATE_HZ = 100
STRIDES = 2
SPEED_MM_PER_S = 1200.0
NOISE_MM = 0.3
PELVIS_HEIGHT_MM = 950.0
# ISB axes (x anterior, y superior, z right), mm; pelvis from mid-ASIS, thigh from the hip joint centre
PELVIS = {"RASI": (0, 0, 120), "LASI": (0, 0, -120), "RPSI": (-150, 0, 45), "LPSI": (-150, 0, -45)}
JOINT_CENTRE = np.array([-45.6, -72.0, 86.4])
THIGH = {"RTH1": (60, -130, 40), "RTH2": (70, -210, 25), "RTH3": (65, -290, 20), "RTH4": (10, -150, 85),
         "RTH5": (15, -230, 75), "RTH6": (5, -310, 60), "RKNE": (0, -400, 55), "RKNM": (0, -400, -50)}
# how far each thigh marker slides up at 40 degrees of flexion, mm: most near the hip, least at the knee
SLIDE = {"RTH1": 12, "RTH2": 9, "RTH3": 6, "RTH4": 10, "RTH5": 8, "RTH6": 5, "RKNE": 3, "RKNM": 2}


def turned(axis, degrees):
    """Rotation matrix about axis 0 (x), 1 (y) or 2 (z)."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def frames():
    """Time and a dictionary of marker places (laboratory: x forward, y up, z right), mm, frame by frame."""
    gait = tomllib.loads((pathlib.Path(__file__).parent.parent / "data/movements/gait.toml").read_text())
    noise = np.random.default_rng(1)
    for frame in range(STRIDES * RATE_HZ):
        time = frame / RATE_HZ
        flexion, adduction, rotation = (
            np.interp(time % 1.0, gait["time_s"], gait[name + "_deg"])
            for name in ("flexion", "adduction", "internal_rotation"))
        pelvis = turned(1, 4 * np.sin(2 * np.pi * time)) @ turned(0, 3 * np.cos(2 * np.pi * time))
        origin = np.array([SPEED_MM_PER_S * time, PELVIS_HEIGHT_MM + 20 * np.cos(4 * np.pi * time), 0])
        thigh = turned(2, flexion) @ turned(0, adduction) @ turned(1, rotation)
        places = {name: origin + pelvis @ np.array(place) for name, place in PELVIS.items()}
        for name, place in THIGH.items():
            slid = np.array(place) + [0, SLIDE[name] * flexion / 40, 0]
            places[name] = origin + pelvis @ (JOINT_CENTRE + thigh @ slid)
        yield time, {name: place + noise.normal(0, NOISE_MM, 3) for name, place in places.items()}


def main():
    rows = list(frames())
    names = list(rows[0][1])
    header = "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames"
    lines = [f"PathFileType\t4\t(X/Y/Z)\twalk.trc", header,
             f"{RATE_HZ}\t{RATE_HZ}\t{len(rows)}\t{len(names)}\tmm\t{RATE_HZ}\t1\t{len(rows)}",
             "Frame#\tTime\t" + "\t\t\t".join(names),
             "\t\t" + "\t".join(f"{axis}{k}" for k in range(1, len(names) + 1) for axis in "XYZ"), ""]
    for number, (time, places) in enumerate(rows, 1):
        cells = "\t".join(f"{value:.2f}" for name in names for value in places[name])
        lines.append(f"{number}\t{time:.3f}\t{cells}")
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
