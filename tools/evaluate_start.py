#!/usr/bin/python3
"""Segments the bones of virtual patients with and without landmarks and prints how far the two results lie apart.

usage: evaluate_start.py [--coxa build/release/coxa] [--work DIR] [--count 10] [--first 101] [--voxel 1.5] [--threads 1]

Printed are mean distances of corresponding vertices, everywhere, and, in brackets, of the surfaces from each other where the image shows them.
Patients are drawn by coxa phantom with the seeds first, first + 1, …, sides in turn, off the model by its default; a result without
landmarks is the same as the other where the vertices of femur and hip bone lie at most 0.1 mm apart on average.  One that is not
is flagged where it is refused or its record says "low confidence".
"""
import json
import subprocess

import numpy as np

import evaluation

SAME = 0.1  # mm


def segmented(folder, name, side, landmarks, options):
    """The record, or the words of the refusal."""
    out = folder / name
    if not (out / "segment.json").exists():
        command = [options.coxa, "segment", "--image", folder / "image.nii.gz", "--side", side, "--structures", "bones", "--quiet",
                   "--threads", options.threads, "--out", out] + (["--landmarks", landmarks] if landmarks else [])
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode:
            return " ".join(done.stderr.split())[:120]
    return json.loads((out / "segment.json").read_text())


def main():
    parser = evaluation.parser(__doc__, work="/tmp/coxa_start")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--first", type=int, default=101)
    parser.add_argument("--voxel", type=float, default=1.5)
    parser.add_argument("--threads", default="1")
    options, surfaces = evaluation.begin(parser)
    n_same = n_flagged = n = 0
    for seed in range(options.first, options.first + options.count):
        side = ("left", "right")[seed % 2]
        folder = options.work / f"patient_{seed}"
        if not (folder / "image.nii.gz").exists():
            subprocess.run([str(c) for c in [options.coxa, "phantom", "--side", side, "--seed", seed, "--voxel", options.voxel, "--quiet",
                                             "--threads", options.threads, "--out", folder]], check=True, capture_output=True)
        marks = folder / "landmarks.mrk.json"
        given, none = (segmented(folder, name, side, m, options) for name, m in (("with", marks), ("without", None)))
        n += 1
        if isinstance(given, str) or isinstance(none, str):
            n_flagged += 1
            print(f"{seed} {side}: refused: {given if isinstance(given, str) else none}", flush=True)
            continue
        points = lambda name, bone: surfaces.arrays(surfaces.read(str(folder / name / f"{bone}.ply")))[0]
        apart = {b: np.linalg.norm(points("with", b) - points("without", b), axis=1).mean() for b in ("femur", "hip_bone")}
        surface = {b: evaluation.distances(folder / "with" / f"{b}.ply", folder / "without" / f"{b}.ply", folder / "image.nii.gz", surfaces)["assd"]
                   for b in apart}
        same = max(apart.values()) <= SAME
        low = any("low confidence" in w for w in none["warnings"])
        n_same += same
        n_flagged += not same and low
        print(f"{seed} {side}: femur {apart['femur']:.3f} ({surface['femur']:.3f}) mm apart, hip bone {apart['hip_bone']:.3f} "
              f"({surface['hip_bone']:.3f}) mm; quality {given['figures']['quality']:.2f}, {none['figures']['quality']:.2f}{'; low confidence' if low else ''}", flush=True)
    print(f"{n_same} of {n} the same, {n_flagged} flagged, {n - n_same - n_flagged} neither")


if __name__ == "__main__":
    main()
