#!/usr/bin/python3
"""Segments simulated MRIs made worse: more noise, more shading, less in view.

usage: evaluate_conditions.py --coxa build/release/coxa [--shared ../shared] [--work DIR] [--only NAME,…] [--conditions C,…]

Conditions: snr10 (noise is added until muscle has a signal-to-noise ratio of 10, Rician), shading (the image times a field
from 0.6 to 1.4 along its diagonal, beside the 25 % it has), half (of the volume in view is kept, about the femoral head).
Atlases, landmarks (normal, 3 mm) and distances as in evaluate_segmentation.py, --work being its directory.
"""
import json

import nibabel
import numpy as np

import evaluate_segmentation as segmentation
import evaluation

LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def noisier(image, about, ratio=10.0):
    """Rician noise added to that of the image, whose muscle has about["snr_muscle"].  Muscle is what most of the image is."""
    values = image.get_fdata()
    muscle = np.median(values[values > 0.2 * np.percentile(values, 98)])
    sigma = muscle * np.sqrt(max(0.0, ratio ** -2 - about["snr_muscle"] ** -2))
    rng = np.random.default_rng(1)
    real, imaginary = rng.normal(0, sigma, values.shape), rng.normal(0, sigma, values.shape)
    return nibabel.Nifti1Image(np.hypot(values + real, imaginary).astype(np.float32), image.affine)


def shaded(image, _):
    values = image.get_fdata()
    along = sum(np.linspace(-1, 1, n).reshape([-1 if a == k else 1 for k in range(3)]) for a, n in enumerate(values.shape)) / 3
    return nibabel.Nifti1Image((values * (1 + 0.4 * along)).astype(np.float32), image.affine)


def half_seen(image, about):
    """Half the volume: each side times the cube root of a half, about the head's centre as far as the image goes."""
    size = np.array(image.shape[:3])
    middle = (np.linalg.inv(LPS @ image.affine) @ np.r_[about["head_centre_lps_mm"], 1])[:3]
    kept = np.ceil(size * 0.5 ** (1 / 3)).astype(int)
    first = np.clip(np.round(middle - kept / 2).astype(int), 0, size - kept)
    return image.slicer[tuple(slice(f, f + k) for f, k in zip(first, kept))]


CONDITIONS = {"snr10": noisier, "shading": shaded, "half": half_seen}


def main():
    parser = evaluation.parser(__doc__)
    parser.add_argument("--only", default="m4_left_dess,m10_left_t1")
    parser.add_argument("--conditions", default=",".join(CONDITIONS))
    parser.add_argument("--error", type=float, default=3.0)
    parser.add_argument("--seed", type=int, default=1)
    options, evaluator = evaluation.begin(parser)
    options.atlases = options.work
    print(f"{'':30s} " + " ".join(f"{s:>26s}" for s in segmentation.STRUCTURES) + "   (assd / hd95 / bias, mm)")
    for name in options.only.split(","):
        path = options.shared / "data/phantom" / f"{name}.nii.gz"
        about = json.loads(path.with_name(f"{name}.json").read_text())
        for condition in options.conditions.split(","):
            options.work = options.atlases / "conditions" / condition
            options.work.mkdir(parents=True, exist_ok=True)
            image = options.work / f"{name}.nii.gz"
            nibabel.save(CONDITIONS[condition](nibabel.load(path), about), image)
            good = segmentation.segmented(image, name, options, evaluator)
            cells, lines = segmentation.judge(image, name, options, evaluator) if good else (["failed"] * 4, [])
            print(f"{name + ' ' + condition:30s} " + " ".join(f"{c:>26s}" for c in cells), *lines, sep="\n", flush=True)


if __name__ == "__main__":
    main()
