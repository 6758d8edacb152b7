#!/usr/bin/python3
"""Meshes surfaces with coxa, TetGen, Gmsh and CGAL at about equal numbers of tetrahedra, and compares them.

usage: compare_meshers.py --coxa build/release/coxa [--cgal build/bench/cgal_mesher] [--shared ../shared] [--figure FILE.png]
                          [--tries N] [--without NAME;…] [--work DIR] SURFACE …

TetGen and Gmsh are Debian's programs `tetgen` and `gmsh`; cgal_mesher is built from bench/ with -DCOXA_BENCHMARKS=ON where CGAL
is installed.  A program that is not there is left out.  Each runs at the best settings found for thin cartilage, its element size
searched for until the number of tetrahedra is near coxa's.  Figures by ../shared/eval/mesh_quality.py; time is processor time.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIME_LIMIT = 600  # seconds for one mesh


def run(command, log):
    """Processor seconds; raises RuntimeError with the last words."""
    with open(log, "w") as words:
        before = os.times()
        try:
            status = subprocess.run([str(c) for c in command], stdout=words, stderr=subprocess.STDOUT, timeout=TIME_LIMIT, check=False)
        except subprocess.TimeoutExpired:
            raise RuntimeError(f"took more than {TIME_LIMIT} s") from None
        after = os.times()
    if status.returncode != 0:
        lines = pathlib.Path(log).read_text().strip().splitlines()
        raise RuntimeError(lines[-1] if lines else f"exit code {status.returncode}")
    return after.children_user + after.children_system - before.children_user - before.children_system


def surface_arrays(judge, path):
    from vtk.util.numpy_support import vtk_to_numpy
    surface = judge.read_surface(str(path))
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    return points, vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def read_medit(path):
    words = path.read_text().split()
    at = words.index("Vertices")
    count = int(words[at + 1])
    points = np.array(words[at + 2:at + 2 + 4 * count], float).reshape(-1, 4)[:, :3]
    at = words.index("Tetrahedra")
    count = int(words[at + 1])
    return points, np.array(words[at + 2:at + 2 + 5 * count], int).reshape(-1, 5)[:, :4] - 1


def by_coxa(arguments, _judge, surface, work, _size):
    out = work / "coxa.vtu"
    return run([arguments.coxa, "mesh", "--surface", surface, "--out", out], work / "coxa.log"), out


def write_poly(path, points, triangles):
    lines = [f"{len(points)} 3 0 0"] + [f"{i} {p[0]:.9f} {p[1]:.9f} {p[2]:.9f}" for i, p in enumerate(points)]
    lines += [f"{len(triangles)} 0"] + [f"1\n3 {t[0]} {t[1]} {t[2]}" for t in triangles] + ["0", "0"]
    path.write_text("\n".join(lines) + "\n")


def tetgen(judge, surface, work, name, switches, size):
    write_poly(work / f"{name}.poly", *surface_arrays(judge, surface))
    seconds = run(["tetgen", f"{switches}a{size ** 3 / 8.5:.6f}", work / f"{name}.poly"], work / f"{name}.log")
    return seconds, work / f"{name}.1.node"


def by_tetgen(_arguments, judge, surface, work, size):
    # Y keeps the surface's triangles: without it thin shells get ten times the elements; where they are large, their number
    # bounds that of the elements
    return tetgen(judge, surface, work, "tetgen", "-pYq1.2/18O9/7", size)


def by_tetgen_alone(_arguments, judge, surface, work, size):
    """With the right to split the surface's triangles too."""
    return tetgen(judge, surface, work, "tetgen_alone", "-pq1.414/10O9/7", size)


def by_gmsh(_arguments, judge, surface, work, size):
    import vtk
    writer = vtk.vtkSTLWriter()
    writer.SetInputData(judge.read_surface(str(surface)))
    writer.SetFileName(str(work / "gmsh.stl"))
    writer.SetFileTypeToBinary()
    writer.Write()
    script = work / "gmsh.geo"
    script.write_text(f'Merge "gmsh.stl";\nClassifySurfaces{{40*Pi/180, 1, 1, Pi}};\nCreateGeometry;\n'
                      f"Surface Loop(1) = Surface{{:}};\nVolume(1) = {{1}};\nMesh.MeshSizeMin = {size};\nMesh.MeshSizeMax = {size};\n"
                      "Mesh.Optimize = 1;\nMesh.OptimizeThreshold = 0.5;\n")  # Debian's gmsh has no Netgen
    seconds = run(["gmsh", script, "-3", "-nt", "1", "-format", "mesh", "-o", work / "gmsh.mesh"], work / "gmsh.log")
    return seconds, work / "gmsh.mesh"


def by_cgal(arguments, judge, surface, work, size, ridge_degrees=180):
    points, triangles = surface_arrays(judge, surface)
    off = work / "cgal.off"
    off.write_text(f"OFF\n{len(points)} {len(triangles)} 0\n" + "\n".join(f"{p[0]:.9f} {p[1]:.9f} {p[2]:.9f}" for p in points) + "\n" +
                   "\n".join(f"3 {t[0]} {t[1]} {t[2]}" for t in triangles) + "\n")
    return run([arguments.cgal, off, size, 0.05, ridge_degrees, work / "cgal.mesh"], work / "cgal.log"), work / "cgal.mesh"


def by_cgal_with_ridges(arguments, judge, surface, work, size):
    return by_cgal(arguments, judge, surface, work, size, 60)


def measured(judge, mesh, surface):
    points, tets = read_medit(mesh) if mesh.suffix == ".mesh" else judge.read_tets(str(mesh))
    truth = judge.read_surface(str(surface))
    volumes, dihedral, aspect = judge.quality(points, tets)
    envelope = judge.to_polydata(points, judge.boundary(tets))
    there, back = judge.distances(judge.samples(truth), envelope), judge.distances(judge.samples(envelope), truth)
    both = np.concatenate([there, back])
    return {"tets": len(tets), "aspect": aspect, "dihedral": dihedral, "inverted": int((volumes <= 0).sum()),
            "rms": np.sqrt(np.mean(both ** 2)), "max": both.max()}


def best_of(make, arguments, judge, surface, work, target):
    """The mesh nearest to the target number of tetrahedra."""
    points, triangles = surface_arrays(judge, surface)
    corners = points[triangles]
    volume = abs(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6
    size, best, tried = (8.5 * volume / target) ** (1 / 3), None, []
    for _ in range(arguments.tries):
        seconds, mesh = make(arguments, judge, surface, work, size)
        figures = {**measured(judge, mesh, surface), "seconds": seconds}
        if best is None or abs(np.log(figures["tets"] / target)) < abs(np.log(best["tets"] / target)):
            best = figures
        if abs(figures["tets"] / target - 1) < 0.1:
            break
        tried.append((np.log(size), np.log(figures["tets"] / target)))
        size = np.exp(next_size(tried))
    return best


def next_size(tried):
    """Logarithm of the element size to try next, from pairs of such and of the ratio of numbers got: between the nearest two on both
    sides of the number wanted, or else as far as the last two, or a thin body, suggest."""
    above, below = [t for t in tried if t[1] > 0], [t for t in tried if t[1] <= 0]
    if above and below:
        (a, u), (b, v) = min(above, key=lambda t: t[1]), max(below, key=lambda t: t[1])
        return a + u / (u - v) * (b - a)
    slope = 2.5  # between a surface's and a body's
    if len(tried) > 1 and tried[-1][0] != tried[-2][0]:
        slope = min(max(-(tried[-1][1] - tried[-2][1]) / (tried[-1][0] - tried[-2][0]), 1.0), 4.0)
    return tried[-1][0] + tried[-1][1] / slope


SHOWN = ("coxa", "TetGen", "Gmsh", "CGAL, ridges")  # CGAL at its better setting


def draw(results, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2))
    for name in (n for n in SHOWN if n in results):
        figures = results[name]
        axes[0].hist(figures["dihedral"].ravel(), bins=90, range=(0, 180), density=True, histtype="step", label=name)
        axes[1].hist(figures["aspect"], bins=50, range=(0, 1), density=True, histtype="step", label=name)
    axes[0].set_xlabel("dihedral angle [°]")
    axes[1].set_xlabel("aspect ratio 3 r_in / r_circ")
    axes[1].legend(loc="upper left")
    for axis in axes:
        axis.set_yticks([])
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--coxa", type=pathlib.Path, default=ROOT / "build/release/coxa")
    parser.add_argument("--cgal", type=pathlib.Path, default=ROOT / "build/bench/cgal_mesher")
    parser.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/coxa_compare"))
    parser.add_argument("--tries", type=int, default=5, help="element sizes tried to meet coxa's number of tetrahedra")
    parser.add_argument("--without", default="", help="meshers left out, by their names in the table, between semicolons")
    parser.add_argument("--figure", type=pathlib.Path, help="histograms of all surfaces together")
    parser.add_argument("surfaces", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.shared / "eval"))
    import mesh_quality as judge

    arguments.work.mkdir(parents=True, exist_ok=True)
    meshers = {"coxa": by_coxa, "TetGen": by_tetgen, "TetGen, surface split": by_tetgen_alone,
               "Gmsh": by_gmsh, "CGAL": by_cgal, "CGAL, ridges": by_cgal_with_ridges}
    there = {"coxa": arguments.coxa.exists(), "TetGen": shutil.which("tetgen"),
             "TetGen, surface split": shutil.which("tetgen"), "Gmsh": shutil.which("gmsh"), "CGAL": arguments.cgal.exists(),
             "CGAL, ridges": arguments.cgal.exists()}
    gathered = {}
    print("| surface | mesher | tets | aspect mean | p05 | min | dihedral min | max | mean | inverted | envelope rms | max | s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for surface in arguments.surfaces:
        name, target = "/".join(surface.with_suffix("").parts[-3:]), 20000
        for mesher, make in ((m, made_by) for m, made_by in meshers.items() if m not in arguments.without.split(";")):
            if not there[mesher]:
                print(f"| {name} | {mesher} | not installed |")
                continue
            try:
                f = best_of(make, argparse.Namespace(**{**vars(arguments), "tries": 1}) if mesher == "coxa" else arguments, judge, surface,
                            arguments.work, target)
            except (RuntimeError, OSError, ValueError) as error:
                print(f"| {name} | {mesher} | failed: {str(error)[:100]} |", flush=True)
                continue
            if mesher == "coxa":
                target = f["tets"]
            gathered.setdefault(mesher, []).append(f)
            print(f"| {name} | {mesher} | {f['tets']} | {f['aspect'].mean():.3f} | {np.percentile(f['aspect'], 5):.3f} | "
                  f"{f['aspect'].min():.3f} | {f['dihedral'].min():.1f} | {f['dihedral'].max():.1f} | {f['dihedral'].mean():.2f} | "
                  f"{f['inverted']} | {f['rms']:.3f} | {f['max']:.3f} | {f['seconds']:.1f} |", flush=True)
    if arguments.figure and gathered:
        arguments.figure.parent.mkdir(parents=True, exist_ok=True)
        draw({m: {k: np.concatenate([f[k].ravel() for f in fs]) for k in ("aspect", "dihedral")} for m, fs in gathered.items()}, arguments.figure)


if __name__ == "__main__":
    main()
