#!/usr/bin/python3
"""Registers other people's simulated MRIs to one with elastix and carries their surfaces over: what atlas registration gives on the images of evaluate_segmentation.py.

usage: compare_elastix.py PHANTOM,… [--shared ../shared] [--work DIR] [--error MM] [--seed N] [--atlases 5] [--threads 2]

Needs Debian's elastix (apt-get install elastix).  Training subjects are those of the atlas that evaluate_segmentation.py takes for the phantom: nobody of
its group (GROUPS there).  Each one's image, mirrored where it shows the other side, is laid on by the same noisy landmarks (rigid and size), then registered:
affine, then B-splines with a final grid of 10 mm, mutual information (contrasts differ), a mask 15 mm about the bones.  The *single* atlas is the training
image of the same contrast that fits best after registration (its metric); the *several* are the mean of the signed distances of all.  Every hip bone of these
images is one person's, warped, and all atlases here have it: elastix' hip-bone figures are flattered, coxa's atlas has none of them.
"""
import os
import re
import resource
import sys
import time

import nibabel
import numpy as np
import vtk
from scipy import ndimage
from vtk.util.numpy_support import numpy_to_vtk

import cartilage_figures
import evaluate_segmentation as ours
import evaluation

MASK_REACH = 15.0  # mm about the bones: the joint and what borders on it
FUSION_STEP = 0.6  # mm, grid of the signed distances
COMMON = """(FixedInternalImagePixelType "float") (MovingInternalImagePixelType "float") (UseDirectionCosines "true")
(Registration "MultiResolutionRegistration") (Metric "AdvancedMattesMutualInformation") (NumberOfHistogramBins 32)
(Interpolator "LinearInterpolator") (ResampleInterpolator "FinalBSplineInterpolator") (Resampler "DefaultResampler")
(FixedImagePyramid "FixedSmoothingImagePyramid") (MovingImagePyramid "MovingSmoothingImagePyramid")
(Optimizer "AdaptiveStochasticGradientDescent") (AutomaticParameterEstimation "true") (HowToCombineTransforms "Compose")
(ImageSampler "RandomCoordinate") (NewSamplesEveryIteration "true") (RequiredRatioOfValidSamples 0.05)
(WriteResultImage "false") (ErodeMask "false") """
AFFINE = COMMON + '(Transform "AffineTransform") (AutomaticScalesEstimation "true") (NumberOfResolutions 3) (MaximumNumberOfIterations 400) (NumberOfSpatialSamples 3000)'
SPLINE = COMMON + ('(Transform "BSplineTransform") (FinalGridSpacingInPhysicalUnits 10.0) (NumberOfResolutions 4)'
                   ' (MaximumNumberOfIterations 700) (NumberOfSpatialSamples 5000)')


def contrast_of(name):
    return "dess" if "dess" in name else "t1"


def training(name, shared):
    """Names of the images of subjects outside the phantom's group: one image of each hip, those of its contrast first."""
    group = next(g for g in ours.GROUPS if ours.subject_and_side(name)[0] in g)
    names = [p.name[: -len(".nii.gz")] for p in sorted((shared / "data/phantom").glob("m*.nii.gz"))]
    names = [n for n in names if ours.subject_and_side(n)[0] not in group]
    return sorted(names, key=lambda n: contrast_of(n) != contrast_of(name))


def parameters(text, path):
    path.write_text("\n".join("(" + part.strip() for part in text.split("(") if part.strip()) + "\n")
    return path


def mirrored_image(source, target):
    """The image of the other side: voxels and frame mirrored in x, so that the frame stays right-handed."""
    image = nibabel.load(source)
    affine = np.diag([-1.0, 1, 1, 1]) @ image.affine
    affine[:3, 3] += affine[:3, 0] * (image.shape[0] - 1)
    affine[:3, 0] *= -1
    out = nibabel.Nifti1Image(np.asarray(image.dataobj)[::-1], affine)
    out.set_sform(affine, 1)
    out.set_qform(affine, 1)
    nibabel.save(out, target)


def write(data, path):
    writer = vtk.vtkPLYWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.Write()


def bone_mask(image_path, meshes, target):
    """Voxels within MASK_REACH of any of the meshes' vertices."""
    image = nibabel.load(image_path)
    to_voxel = np.linalg.inv(np.diag([-1.0, -1, 1, 1]) @ image.affine)
    marked = np.ones(image.shape, bool)
    for points, _ in meshes:
        voxels = np.rint(points @ to_voxel[:3, :3].T + to_voxel[:3, 3]).astype(int)
        voxels = voxels[((voxels >= 0) & (voxels < image.shape)).all(1)]
        marked[tuple(voxels.T)] = False
    near = ndimage.distance_transform_edt(marked, sampling=np.linalg.norm(image.affine[:3, :3], axis=0)) < MASK_REACH
    out = nibabel.Nifti1Image(near.astype(np.uint8), image.affine)
    nibabel.save(out, target)


def start_from_landmarks(atlas, patient, path):
    """Similarity from the atlas' landmarks to the patient's (Umeyama 1991), as an elastix transform; fixed is the atlas."""
    names = sorted(set(atlas) & set(patient))
    a, b = (np.array([marks[n] for n in names]) for marks in (atlas, patient))
    ca, cb = a.mean(0), b.mean(0)
    u, s, vt = np.linalg.svd((b - cb).T @ (a - ca))
    d = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    matrix = (s @ np.diag(d)) / ((a - ca) ** 2).sum() * u @ d @ vt
    shift = cb - matrix @ ca
    numbers = " ".join(f"{x:.9g}" for x in [*matrix.ravel(), *shift])
    path.write_text('(Transform "AffineTransform")\n(NumberOfParameters 12)\n(TransformParameters ' + numbers + ')\n'
                    '(InitialTransformParametersFileName "NoInitialTransform")\n(HowToCombineTransforms "Compose")\n'
                    '(FixedImageDimension 3)\n(MovingImageDimension 3)\n(FixedInternalImagePixelType "float")\n'
                    '(MovingInternalImagePixelType "float")\n(UseDirectionCosines "true")\n(CenterOfRotationPoint 0 0 0)\n'
                    '(Size 1 1 1)\n(Index 0 0 0)\n(Spacing 1 1 1)\n(Origin 0 0 0)\n(Direction 1 0 0 0 1 0 0 0 1)\n')


def carried(points, transform, folder):
    """Points of the atlas image where the registration puts them."""
    listed = folder / "points.txt"
    np.savetxt(listed, points, fmt="%.6f", header=f"point\n{len(points)}", comments="")
    evaluation.run(["transformix", "-def", listed, "-tp", transform, "-out", folder])
    lines = (folder / "outputpoints.txt").read_text().splitlines()
    return np.array([re.search(r"OutputPoint = \[ (.*?) \]", line).group(1).split() for line in lines], float)


def register(name, other, patient_marks, options, evaluator):
    """Surfaces of `other` carried into the image of `name`, the metric (the less the better), seconds and processor seconds."""
    folder = options.work / f"{name}_from_{other}"
    folder.mkdir(parents=True, exist_ok=True)
    flip = ours.subject_and_side(name)[1] != ours.subject_and_side(other)[1]
    mirror = np.array([-1.0 if flip else 1.0, 1, 1])
    source, image = options.shared / f"data/phantom/{other}.nii.gz", folder / "atlas.nii.gz"
    if flip:
        mirrored_image(source, image)
    else:
        nibabel.save(nibabel.load(source), image)
    meshes = {}
    for s in ours.STRUCTURES:
        points, triangles = evaluator.arrays(evaluator.read(str(ours.truth_path(options.shared, *ours.subject_and_side(other), s))))
        meshes[s] = (points * mirror, triangles[:, ::-1] if flip else triangles)
    bone_mask(image, [meshes["femur"], meshes["hip_bone"]], folder / "mask.nii.gz")
    marks = {k: p * mirror for k, p in ours.landmarks_of(options.shared, other, evaluator).items()}
    start_from_landmarks(marks, patient_marks, folder / "start.txt")
    begin, used = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN)
    evaluation.run(["elastix", "-f", image, "-m", options.shared / f"data/phantom/{name}.nii.gz", "-fMask", folder / "mask.nii.gz", "-t0", folder / "start.txt",
              "-p", parameters(AFFINE, folder / "affine.txt"), "-p", parameters(SPLINE, folder / "spline.txt"), "-threads", options.threads, "-out", folder])
    transform = folder / "TransformParameters.1.txt"
    if not transform.exists():
        sys.exit(f"elastix gave no transform for {other} to {name}: see {folder / 'elastix.log'}")
    metric = float(re.findall(r"Final metric value\s*=\s*(\S+)", (folder / "elastix.log").read_text())[-1])
    surfaces = {s: (carried(p, transform, folder), t) for s, (p, t) in meshes.items()}
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    return surfaces, metric, time.time() - begin, now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime


def fused(surfaces, evaluator):
    """Zero of the mean signed distance of closed surfaces."""
    clouds = np.vstack([p for p, _ in surfaces])
    origin = clouds.min(0) - 5.0
    dims = np.ceil((clouds.max(0) + 5.0 - origin) / FUSION_STEP).astype(int) + 1
    mean = np.zeros(dims[::-1], np.float32)
    for points, triangles in surfaces:
        inside = np.asarray(evaluator.fill(cartilage_figures.surface_of(points, triangles), origin, dims, FUSION_STEP)).reshape(dims[::-1]) > 0
        mean += ndimage.distance_transform_edt(~inside) - ndimage.distance_transform_edt(inside)
    grid = vtk.vtkImageData()
    grid.SetDimensions(*dims)
    grid.SetSpacing(FUSION_STEP, FUSION_STEP, FUSION_STEP)
    grid.SetOrigin(*origin)
    grid.GetPointData().SetScalars(numpy_to_vtk(mean.ravel(), deep=True))
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(grid)
    contour.SetValue(0, 0.0)
    contour.Update()
    return contour.GetOutput()


def print_figures(label, name, folder, seconds, processor, options, evaluator):
    cells, lines = [], []
    for s in ours.STRUCTURES:
        truth = ours.truth_path(options.shared, *ours.subject_and_side(name), s)
        d = evaluation.distances(folder / f"{s}.ply", truth, options.shared / f"data/phantom/{name}.nii.gz", evaluator)
        cells.append(f"{s} {d['assd']:.2f} / {d['hd95']:.2f}")
        if s.endswith("cartilage"):
            f = cartilage_figures.figures(folder / f"{s}.ply", truth, evaluator)
            lines.append(f"    {s:22s} mean thickness {f['thickness']:+.3f}  Dice where thick {f['dice']:.3f}")
    print(f"{name} {label}: " + "; ".join(cells) + f"; {seconds:.0f} s, {processor:.0f} s of processor time", *lines, sep="\n", flush=True)


def compare(name, options, evaluator):
    marks = evaluation.noisy(ours.landmarks_of(options.shared, name, evaluator), name, options.error, options.seed)
    atlases = training(name, options.shared)[: options.atlases]
    found = {other: register(name, other, marks, options, evaluator) for other in atlases}
    same = [o for o in atlases if contrast_of(o) == contrast_of(name)] or atlases
    best = min(same, key=lambda o: found[o][1])
    for label, chosen in ((f"one atlas ({best})", [best]), (f"{len(atlases)} atlases ({', '.join(atlases)})", atlases)):
        folder = options.work / f"{name}_{len(chosen)}"
        folder.mkdir(exist_ok=True)
        for s in ours.STRUCTURES:
            surfaces = [found[o][0][s] for o in chosen]
            write(cartilage_figures.surface_of(*surfaces[0]) if len(surfaces) == 1 else fused(surfaces, evaluator), folder / f"{s}.ply")
        print_figures(label, name, folder, sum(found[o][2] for o in chosen), sum(found[o][3] for o in chosen), options, evaluator)


def main():
    parser = evaluation.parser(__doc__, work="/tmp/coxa_elastix", coxa=False)
    parser.add_argument("phantoms")
    parser.add_argument("--error", type=float, default=3.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--atlases", type=int, default=5)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    options, evaluator = evaluation.begin(parser)
    for name in options.phantoms.split(","):
        compare(name, options, evaluator)


if __name__ == "__main__":
    main()
