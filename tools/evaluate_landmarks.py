#!/usr/bin/python3
"""How far a segmented hip moves when its landmarks are wrong.

usage: evaluate_landmarks.py --coxa build/release/coxa [--shared ../shared] [--work DIR] [--only NAME,…] [--error MM] [--seeds N]

Each simulated image of ../shared/data/phantom (evaluate_segmentation.py: same atlases, same landmarks) is segmented from exact
landmarks, and N times from landmarks moved by vectors spread evenly over a ball of --error (10) mm.  Prints per structure the
average distance (both ways, in view: surface_distance.py --image) of each result from the one of exact landmarks, and from the truth.
"""
import numpy as np

import evaluate_segmentation as segmentation
import evaluation


def moved(marks, error, rng):
    """Landmarks moved by vectors spread evenly over a ball."""
    ways = rng.normal(size=(len(marks), 3))
    ways *= error * rng.random((len(marks), 1)) ** (1 / 3) / np.linalg.norm(ways, axis=1, keepdims=True)
    return {name: p + w for (name, p), w in zip(marks.items(), ways)}


def main():
    parser = evaluation.parser(__doc__)
    parser.add_argument("--only", default="m4_left_dess,m10_left_t1")
    parser.add_argument("--error", type=float, default=10.0)
    parser.add_argument("--seeds", type=int, default=2)
    options, evaluator = evaluation.begin(parser)
    print(f"{'':24s}" + "".join(f"{s:>24s}" for s in segmentation.STRUCTURES) + "   (moved / from the truth, mm)")
    for name in options.only.split(","):
        image = options.shared / "data/phantom" / f"{name}.nii.gz"
        marks = segmentation.landmarks_of(options.shared, name, evaluator)
        subject, side = segmentation.subject_and_side(name)
        exact = options.work / f"{name}_exact"
        for seed in range(options.seeds + 1):
            rng = np.random.default_rng([seed, *name.encode()])
            out = options.work / f"{name}_moved_{seed}" if seed else exact
            if not segmentation.segment(image, name, moved(marks, options.error, rng) if seed else marks, out, options, "--resume"):
                print(f"{out.name:24s} failed", flush=True)
                continue
            cells = []
            for s in segmentation.STRUCTURES:
                file, truth = f"{s}.ply", segmentation.truth_path(options.shared, subject, side, s)
                way = evaluation.distances(out / file, exact / file, image, evaluator)["assd"] if seed else 0.0
                cells.append(f"{way:.3f} / {evaluation.distances(out / file, truth, image, evaluator)['assd']:.3f}")
            print(f"{out.name:24s}" + "".join(f"{c:>24s}" for c in cells), flush=True)


if __name__ == "__main__":
    main()
