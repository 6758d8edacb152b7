#!/usr/bin/python3
"""Makes labrum and ligaments on the bones and cartilages of ../shared/data/visible_human and compares them with ligaments_cc_by_sa.

usage: evaluate_ligaments.py [--coxa build/release/coxa] [--shared ../shared] [--work DIR] [--judge]

Of each structure: average symmetric distance to the reference, and how far the middles of its two ends lie from the
reference's; an end is the tenth of the surface that is farthest from the other bone.  The reference labrum is a closed
ring that crosses the notch, ours ends at the transverse ligament: it is judged with and without the hours of the notch.
The references were looked at for this alone; no figure of the models was chosen by them.
"""
import subprocess

import numpy as np
from scipy.spatial import cKDTree

import evaluation

HIPS = ("vhf/left", "vhf/right", "vhm/left")
ENDS = {"hip_bone": "femur", "femur": "hip_bone"}
SAMPLES = 20000


def spread(path, surfaces, n=SAMPLES):
    """Points spread evenly over a surface."""
    points, triangles = surfaces.arrays(surfaces.read(str(path)))[:2]
    corners = points[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(triangles), n, p=area / area.sum())
    weights = rng.random((n, 2))
    over = weights.sum(1) > 1
    weights[over] = 1 - weights[over]
    a, b, c = (corners[chosen, k] for k in range(3))
    return a + weights[:, :1] * (b - a) + weights[:, 1:] * (c - a)


def distance(ours, theirs):
    return 0.5 * (cKDTree(theirs).query(ours)[0].mean() + cKDTree(ours).query(theirs)[0].mean())


def end_at(points, other_bone):
    """Middle of the tenth that is farthest from the bone at the other end."""
    away = other_bone.query(points)[0]
    return points[away >= np.quantile(away, 0.9)].mean(0)


def outside_notch(points, bridge):
    """Without what lies in the sector of the transverse ligament, seen from the ring's middle."""
    middle = points.mean(0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][2]
    flat = lambda p: (p - middle) - ((p - middle) @ normal)[:, None] * normal
    towards = flat(bridge).mean(0)
    towards /= np.linalg.norm(towards)
    reach = np.min((flat(bridge) @ towards) / np.linalg.norm(flat(bridge), axis=1))
    directions = flat(points)
    return points[(directions @ towards) / np.linalg.norm(directions, axis=1) < reach]


def judge(hip, options, surfaces):
    bones = {b: cKDTree(spread(options.shared / f"data/visible_human/{hip}/{b}.ply", surfaces, 60000)) for b in ENDS}
    folder, reference = options.work / hip, options.shared / "data/ligaments_cc_by_sa" / hip
    read = lambda place, name: spread(place / f"{name}.ply", surfaces)
    ours, theirs, bridge = (read(folder, "acetabular_labrum"), read(reference, "acetabular_labrum"),
                            read(folder, "transverse_acetabular_ligament"))
    print(f"{hip} acetabular_labrum: {distance(ours, theirs):.2f} mm; outside the notch "
          f"{distance(ours, outside_notch(theirs, bridge)):.2f} mm")
    for path in sorted(folder.glob("*ligament*.ply")):
        if not (reference / path.name).exists():
            continue
        ours, theirs = spread(path, surfaces), spread(reference / path.name, surfaces)
        ends = "  ".join(f"{bone} end {np.linalg.norm(end_at(ours, bones[other]) - end_at(theirs, bones[other])):.1f}"
                         for bone, other in ENDS.items())
        print(f"{hip} {path.stem}: {distance(ours, theirs):.2f} mm; {ends} mm", flush=True)


def main():
    parser = evaluation.parser(__doc__, work="/tmp/coxa_ligaments")
    parser.add_argument("--judge", action="store_true")
    options, surfaces = evaluation.begin(parser)
    for hip in HIPS:
        if not options.judge:
            (options.work / hip).parent.mkdir(parents=True, exist_ok=True)
            subprocess.run([str(options.coxa), "segment", "--surfaces", str(options.shared / "data/visible_human" / hip), "--side",
                            hip.split("/")[1], "--structures", "labrum,ligaments", "--out", str(options.work / hip)], check=True)
        judge(hip, options, surfaces)


if __name__ == "__main__":
    main()
