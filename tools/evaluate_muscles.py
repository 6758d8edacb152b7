#!/usr/bin/python3
"""Segments hip and thigh of ../shared/data/phantom/thigh_* with every muscle, atlases free of the body, and prints the distances.

usage: evaluate_muscles.py [--coxa build/release/coxa] [--shared ../shared] [--work DIR] [--only NAME,…] [--judge] [--picture]

Images, landmarks and atlases are those of evaluate_segmentation.py, which see; muscles are judged by the formula of
label_distance.py and by their overlap with the true labels (Dice).  --picture puts outlines over four slices of each image into DIR.
"""
import numpy as np

import evaluate_segmentation as bones
import evaluation
import thigh_phantoms

# what is smaller in view than this is shown but not counted in the mean, ml
LEAST = 5.0


def draw(folder, shared, name, evaluator, out):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import nibabel as nib
    image = np.asarray(nib.load(shared / f"data/phantom/{name}.nii.gz").dataobj)
    labels, affine = thigh_phantoms.read_labels(shared, name)
    figure, axes = plt.subplots(2, 4, figsize=(26, 14))
    slices = [int(labels.shape[2] * share) for share in (0.2, 0.4, 0.6, 0.8)]
    masks = {p.stem: thigh_phantoms.fill(p, labels.shape, affine, evaluator)
             for p in sorted(folder.glob("*.ply")) if not p.stem.startswith("union_")}
    colours = plt.cm.gist_rainbow(np.linspace(0, 1, len(masks)))
    for column, k in enumerate(slices):
        for row in (0, 1):
            axes[row, column].imshow(image[:, :, k].T, cmap="gray")
            axes[row, column].set_title(f"{name} slice {k}" + (" truth" if row else ""))
        for colour, mask in zip(colours, masks.values()):
            if mask[:, :, k].any():
                axes[0, column].contour(mask[:, :, k].T.astype(float), [0.5], colors=[colour], linewidths=1)
        for value in np.unique(labels[:, :, k]):
            if 0 < value < 31:
                axes[1, column].contour((labels[:, :, k] == value).T.astype(float), [0.5], colors=[plt.cm.tab20(value % 20)], linewidths=1)
    plt.tight_layout()
    plt.savefig(out, dpi=50)


def judge(folder, name, options, evaluator):
    rows = thigh_phantoms.judge_muscles(folder, options.shared, name, evaluator)
    for structures, volume, assd, hd95, bias, dice in rows:
        print(f"  {structures:52s} {volume:7.0f} ml   {assd:6.2f} / {hd95:6.2f} / {bias:+6.2f}   Dice {dice:.3f}")
    large = np.array([r[1:] for r in rows if r[1] >= LEAST and np.isfinite(r[2])])
    if len(large):
        print(f"{name}: {len(large)} of at least {LEAST:.0f} ml: mean {large[:, 1].mean():.2f} mm, median {np.median(large[:, 1]):.2f} mm, "
              f"Dice mean {large[:, 4].mean():.3f}, by volume {np.average(large[:, 4], weights=large[:, 0]):.3f}", flush=True)


def main():
    parser = evaluation.parser(__doc__)
    parser.add_argument("--error", type=float, default=3.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--judge", action="store_true")
    parser.add_argument("--picture", action="store_true")
    options, evaluator = evaluation.begin(parser)
    options.structures = "bones,muscles"
    wanted = [w for w in options.only.split(",") if w]
    for image in sorted((options.shared / "data/phantom").glob("thigh_*.nii.gz")):
        name = image.name[: -len(".nii.gz")]
        if name.endswith("_labels") or (wanted and name not in wanted):
            continue
        if not options.judge and not bones.segmented(image, name, options, evaluator):
            print(f"{name}: failed", flush=True)
            continue
        judge(options.work / name, name, options, evaluator)
        if options.picture:
            draw(options.work / name, options.shared, name, evaluator, options.work / f"{name}.png")


if __name__ == "__main__":
    main()
