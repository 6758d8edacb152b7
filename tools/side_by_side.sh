#!/usr/bin/env bash
# coxa beside other programs on the cartilages of the demo's patient, in one run: TetGen, Gmsh and CGAL mesh the same surface, CalculiX presses the
# same head into the same socket. Figures of meshes need the evaluator of ../shared/eval and are passed over without it.
# Usage: tools/side_by_side.sh BUILD
set -euo pipefail
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
work=build/side_by_side
mkdir -p "$work"

[ -d demo/result/joint ] || tools/demo.sh
if [ -e ../shared/eval/mesh_quality.py ]; then
  echo "== meshers on the acetabular cartilage"
  tools/compare_meshers.py --coxa "$build/coxa" --cgal "$build/cgal_mesher" --tries 4 --work "$work/meshers" demo/result/segment/acetabular_cartilage.ply
else
  echo "== meshers: passed over, ../shared/eval is not there"
fi
echo "== a head pressed into its socket: coxa and CalculiX on the same meshes"
# 0.4 mm against the opening axis of a right socket: up, inward and back
tools/calculix_hip.py demo/result/joint/joint.toml --way 0.4 --along 0.72 0.34 0.60 --press "$build/joint_press" --work "$work/hip"
