#!/usr/bin/python3
"""Gives coxa segment the wrong images that users give it, and prints whether it says so.

usage: evaluate_refusals.py [--coxa build/release/coxa] [--shared ../shared] [--work DIR] [--base NAME,…] [--only CASE,…] [--ways landmarks,none]

Every case is made from a phantom of ../shared/data/phantom at 1.5 mm (base) and run with landmarks (3 mm off, carried along as a
person would set them in that image) and without.  The outcome is
  refused   an exit code other than 0, with the error's words
  low       a result whose record says "low confidence"
  right     a result without such words, the femur at most 3 mm off on average where it is in the image
  WRONG     a result without such words and no hip there, or the femur farther off
Atlases are those of evaluate_segmentation.py, kept in DIR.  The last line counts what is WRONG; it is the exit code.
"""
import json
import subprocess
import sys

import nibabel as nib
import numpy as np
from scipy import ndimage as ndi

import evaluate_segmentation as bones
import evaluation

LARGEST = 3.0  # mm, mean distance of a femur that counts as right
LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


class Case:
    """What a person hands in, and whether the hip of that side is in the image as the truth has it."""

    def __init__(self, values, affine, marks, side, hip=True):
        self.values, self.affine, self.marks, self.side, self.hip = values, affine.copy(), dict(marks), side, hip

    def copy(self, **changes):
        new = Case(self.values.copy(), self.affine, self.marks, self.side, self.hip)
        for name, value in changes.items():
            setattr(new, name, value)
        return new

    def positions(self):
        """LPS mm of every voxel."""
        grid = np.stack(np.meshgrid(*[np.arange(n) for n in self.values.shape], indexing="ij"), -1)
        return grid @ self.affine[:3, :3].T + self.affine[:3, 3]

    def index(self, point):
        return np.linalg.solve(self.affine[:3, :3], point - self.affine[:3, 3])

    def cut(self, low, high):
        """Only the voxels from low to high, LPS mm (axis-parallel images)."""
        corners = np.sort([self.index(np.array(low)), self.index(np.array(high))], 0)
        a = np.clip(np.round(corners[0]).astype(int), 0, None)
        b = np.minimum(np.round(corners[1]).astype(int) + 1, self.values.shape)
        affine = self.affine.copy()
        affine[:3, 3] += affine[:3, :3] @ a
        return self.copy(values=self.values[a[0]:b[0], a[1]:b[1], a[2]:b[2]].copy(), affine=affine)

    def shifted(self, way):
        return {name: p + way for name, p in self.marks.items()}


def wrong_side(base):
    return base.copy(side="right" if base.side == "left" else "left", hip=False)


def metal(diameter):
    """No signal about the head; near it the image is pulled inwards and piled up to a bright rim."""
    def make(base):
        p = base.positions()
        centre = base.marks["femoral_head_centre"]
        r = np.linalg.norm(p - centre, axis=-1) + 1e-9
        radius = diameter / 2
        # a place r shows what lies nearer, as far as twice the radius
        source = np.where(r < 2 * radius, np.maximum(0, 2 * radius - (2 * radius - r) * 1.5), r)
        index = np.moveaxis((centre + (p - centre) * (source / r)[..., None] - base.affine[:3, 3]) @ np.linalg.inv(base.affine[:3, :3]).T, -1, 0)
        values = ndi.map_coordinates(base.values, index, order=1, mode="nearest")
        values *= 1 + 1.5 * np.exp(-0.5 * ((r - radius - 2) / 2) ** 2)
        noise = 0.02 * np.percentile(base.values, 98) * np.abs(np.random.default_rng(1).normal(size=r.shape))
        return base.copy(values=np.where(r < radius, noise, values))
    return make


def above(base):
    """Of the image only what lies 35 mm above the head's centre, and no landmark moved."""
    c = base.marks["femoral_head_centre"]
    new = base.cut(c + [-500, -500, 15], c + [500, 500, 500])
    new.hip = False
    return new


def box(half):
    def make(base):
        c = base.marks["femoral_head_centre"]
        return base.cut(c - half, c + half)
    return make


def half_field(base):
    """The outer half of the image: the head is cut."""
    c, out = base.marks["femoral_head_centre"], (1 if base.side == "left" else -1)
    return base.cut(c + [-500 if out < 0 else 0, -500, -500], c + [0 if out < 0 else 500, 500, 500])


def inverted(base):
    """Bright where it was dark, air stays dark: a fat-suppressed T2 image."""
    top = np.percentile(base.values, 99)
    body = ndi.binary_closing(ndi.gaussian_filter(base.values, 2) > 0.15 * top, iterations=4)
    return base.copy(values=np.where(body, np.clip(1.05 * top - base.values, 0, None), base.values))


def fluid_weighted(base):
    """T2 without suppression: fat and marrow grey, muscle dark, fluid and cartilage bright."""
    top = np.percentile(base.values, 99)
    x = np.clip(base.values / top, 0, 1)
    return base.copy(values=top * np.interp(x, [0, 0.15, 0.45, 0.6, 0.8, 1.0], [0, 0.1, 0.15, 0.9, 0.55, 0.5]))


def localizer(base):
    """Five slices through the hip."""
    k = int(round(base.index(base.marks["femoral_head_centre"])[2]))
    slices = [s for s in (k - 14, k - 7, k, k + 7, k + 14)]
    affine = base.affine.copy()
    affine[:3, 3] += affine[:3, 2] * slices[0]
    affine[:3, 2] *= 7
    return base.copy(values=base.values[:, :, slices].copy(), affine=affine)


def noise(base):
    values = np.abs(np.random.default_rng(2).normal(100, 40, base.values.shape))
    return base.copy(values=ndi.gaussian_filter(values, 1.0), hip=False)


def flipped(axes):
    """The array turned over along these axes, the header as it was; landmarks as they are seen there."""
    def make(base):
        values = np.flip(base.values, axes)
        marks = {}
        for name, p in base.marks.items():
            i = base.index(p)
            for a in axes:
                i[a] = base.values.shape[a] - 1 - i[a]
            marks[name] = base.affine[:3, :3] @ i + base.affine[:3, 3]
        return base.copy(values=values.copy(), marks=marks, hip=False)
    return make


def misplaced(way):
    """The landmarks of another place of this image."""
    def make(base):
        return base.copy(marks=base.shifted(np.array(way)))
    return make


def knee(shared):
    """Distal femur, patella and, for want of a tibia, the femur's mirror image, in muscle and fat; bones marrow in cortex."""
    def make(base):
        sys.path.insert(0, str(shared / "eval"))
        import surface_distance
        import thigh_phantoms
        folder = shared / "data/visible_human/vhf/left"
        femur = surface_distance.arrays(surface_distance.read(str(folder / "femur.ply")))[0]
        low = femur[:, 2].min()
        ends = femur[femur[:, 2] < low + 90]
        spacing, origin = 1.5, np.array([*(ends.min(0)[:2] - 35), low - 95])
        shape = tuple(np.ceil((np.array([*(ends.max(0)[:2] + 35), low + 90]) - origin) / spacing).astype(int))
        affine = np.diag([spacing] * 3 + [1.0])
        affine[:3, 3] = origin
        fill = lambda name: thigh_phantoms.fill(folder / f"{name}.ply", shape, affine, surface_distance)
        bone = fill("femur")
        end = int(round((low - origin[2]) / spacing))
        tibia = np.zeros_like(bone)
        tibia[:, :, :end - 3] = bone[:, :, end:2 * end - 3][:, :, ::-1]
        bone |= tibia | fill("patella")
        grid = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), -1) * spacing + origin
        radius = np.hypot(grid[..., 0] - ends[:, 0].mean(), grid[..., 1] - ends[:, 1].mean())
        values = np.where(radius < 45, 60.0, np.where(radius < 62, 160.0, 3.0))
        values[bone] = 15.0
        values[ndi.binary_erosion(bone, iterations=2)] = 150.0
        values = ndi.gaussian_filter(values, 0.6) + np.random.default_rng(3).normal(0, 4, shape)
        way = grid.reshape(-1, 3).mean(0) - np.mean(list(base.marks.values()), 0)
        return base.copy(values=np.abs(values), affine=affine, marks=base.shifted(way), hip=False)
    return make


def cases(shared):
    return {"as it is": lambda b: b, "wrong side": wrong_side, "metal, 35 mm": metal(35), "metal, 60 mm": metal(60),
            "hip above the image's lower end": above, "box of 120 mm": box(60), "box of 80 mm": box(40), "outer half": half_field,
            "inverted (T2, fat suppressed)": inverted, "fluid bright (T2)": fluid_weighted, "5-slice localizer": localizer,
            "noise": noise, "upside down, mirrored (z)": flipped((2,)), "left and right swapped (x)": flipped((0,)),
            "turned over (y and z)": flipped((1, 2)), "knee": knee(shared), "landmarks 40 mm too low": misplaced([0, 0, -40]),
            "landmarks 40 mm too far back": misplaced([0, 40, 0])}


def read_base(options, name, evaluator):
    image = nib.load(options.shared / f"data/phantom/{name}.nii.gz")
    values, affine = np.asarray(image.dataobj, dtype=np.float32), LPS @ image.affine
    steps = np.maximum(1, np.round(1.5 / np.linalg.norm(affine[:3, :3], axis=0))).astype(int)
    values = ndi.uniform_filter(values, steps)
    first = steps // 2
    values = values[first[0]::steps[0], first[1]::steps[1], first[2]::steps[2]]
    # the mean over an even number of voxels lies half a voxel before the one it is written to
    affine[:3, 3] += affine[:3, :3] @ (first - np.where(steps % 2 == 0, 0.5, 0.0))
    affine[:3, :3] *= steps
    marks = evaluation.noisy(bones.landmarks_of(options.shared, name, evaluator), name, error=3.0, seed=1)
    return Case(values, affine, marks, name.split("_")[1])


def outcome(case, way, stem, name, options, evaluator):
    """(word, why)"""
    image = options.work / f"{stem}.nii.gz"
    nib.save(nib.Nifti1Image(case.values.astype(np.float32), LPS @ case.affine), image)
    command = [options.coxa, "segment", "--image", image, "--side", case.side, "--atlas", bones.atlas_without(name, options),
               "--structures", "bones", "--quiet", "--threads", "1", "--out", options.work / stem]
    if way == "landmarks":
        table = options.work / f"{stem}.csv"
        table.write_text("name,x,y,z\n" + "".join(f"{k},{p[0]:.3f},{p[1]:.3f},{p[2]:.3f}\n" for k, p in case.marks.items()))
        command += ["--landmarks", table]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        return "refused", " ".join(done.stderr.split())[:150]
    record = json.loads((options.work / stem / "segment.json").read_text())
    said = [w for w in record["warnings"] if "low confidence" in w]
    distance = np.inf
    if case.hip:
        subject, side = bones.subject_and_side(name)
        truth = bones.truth_path(options.shared, subject, side, "femur")
        distance = evaluation.distances(options.work / stem / "femur.ply", truth, image, evaluator)["assd"]
    word = "low" if said else "right" if distance <= LARGEST else "WRONG"
    return word, f"femur {distance:.2f} mm off, quality {record['figures']['quality']:.2f}" + (f"; {said[0][:100]}" if said else "")


def main():
    parser = evaluation.parser(__doc__)
    parser.add_argument("--base", default="m4_left_dess,m3_right_t1")
    parser.add_argument("--only", default="")
    parser.add_argument("--ways", default="landmarks,none")
    options, evaluator = evaluation.begin(parser)
    wanted = [w for w in options.only.split(",") if w]
    n_wrong = 0
    for name in options.base.split(","):
        base = read_base(options, name, evaluator)
        for number, (title, make) in enumerate(cases(options.shared).items()):
            if wanted and title not in wanted and str(number) not in wanted:
                continue
            case = make(base)
            for way in options.ways.split(","):
                if title.startswith("landmarks") and way == "none":
                    continue
                word, why = outcome(case, way, f"refusal_{name}_{number}_{way}", name, options, evaluator)
                n_wrong += word == "WRONG"
                print(f"{name:14s} {number:2d} {title:32s} {way:10s} {word:8s} {why}", flush=True)
    print(f"{n_wrong} WRONG")
    return n_wrong


if __name__ == "__main__":
    sys.exit(main())
