#include <coxa/segment/uncertainty.h>

#include <coxa/core/parallel.h>
#include <coxa/mesh/topology.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>

#include "coverage_rays.h"
#include "layer_sheet.h"

namespace coxa::segment {
namespace {

// mm over which the influence of the view's edge, of a layer's rim and of the way outside changes
constexpr double kEdge = 4.0, kRim = 3.0, kBeyond = 5.0;
// the voxels that blur is counted from: half of 0.8 mm; beyond half of 10 mm nothing is found
constexpr double kSharp = 0.4, kBlurred = 5.0;

/// mm inside the box of voxel centres; negative: outside.
double depth_in(const Volume& volume, const Vec3& p) {
  const Vec3 from_first = volume.index(p).cwiseProduct(volume.spacing);
  double inside = kInfinity;
  Vec3 outside = Vec3::Zero();
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(volume.size[static_cast<std::size_t>(a)] - 1);
    const double margin = std::min(from_first[a], last * volume.spacing[a] - from_first[a]);
    inside = std::min(inside, margin);
    outside[a] = std::min(margin, 0.0);
  }
  return inside >= 0.0 ? inside : -outside.norm();
}

void add_layer(const TriMesh& surface, Index n_bone_side, Evidence& evidence) {
  const LayerSheet layer = sheet_of(surface, n_bone_side);
  evidence.far_side = VecX::Ones(surface.n_vertices());
  evidence.far_side.head(layer.sheet.n_vertices()).setZero();
  std::vector<Index> rim_vertices;
  for (const auto& loop : boundary_loops(layer.sheet))
    rim_vertices.insert(rim_vertices.end(), loop.begin(), loop.end());
  parallel_for(surface.n_vertices(), [&](Index v) {
    double least = kInfinity;
    for (const Index r : rim_vertices)
      least = std::min(least, (surface.points.row(v) - surface.points.row(r)).squaredNorm());
    evidence.rim_distance[v] = std::sqrt(least);
  });
}

}  // namespace

VecX uncertainties(const Evidence& evidence, const Calibration& c) {
  VecX half_width(evidence.confidence.size());
  for (Eigen::Index v = 0; v < half_width.size(); ++v) {
    const double depth = evidence.view_depth[v];
    if (depth < 0.0) {
      half_width[v] = std::exp(c.beyond + c.growth * std::log1p(-depth / kBeyond));
      continue;
    }
    const double blur = std::clamp(evidence.half_voxel[v], kSharp, kBlurred) / kSharp;
    half_width[v] = std::exp(c.constant + c.doubt * (1.0 - evidence.confidence[v]) +
                             c.border * std::log(evidence.border_deviation[v]) +
                             c.edge * std::exp(-depth / kEdge) + c.blur * std::log(blur) +
                             c.rim * std::exp(-evidence.rim_distance[v] / kRim) +
                             c.far_side * evidence.far_side[v]);
  }
  return half_width;
}

Evidence evidence_of_place(const TriMesh& surface, Index n_bone_side,
                           std::span<const Volume* const> images) {
  const Index n = surface.n_vertices();
  const Points normals = vertex_normals(surface);
  Evidence evidence;
  evidence.confidence = VecX::Zero(n);
  evidence.border_deviation = VecX::Constant(n, kUnknownBorder);
  evidence.view_depth = VecX::Constant(n, -kInfinity);
  evidence.half_voxel = VecX::Constant(n, kBlurred);
  evidence.rim_distance = VecX::Constant(n, kInfinity);
  evidence.far_side = VecX::Zero(n);
  parallel_for(n, [&](Index v) {
    const Vec3 p = surface.points.row(v), normal = normals.row(v);
    for (const Volume* image : images) {
      const double depth = depth_in(*image, p);
      evidence.view_depth[v] = std::max(evidence.view_depth[v], depth);
      if (depth >= 0.0)
        evidence.half_voxel[v] = std::min(evidence.half_voxel[v], blur_along(*image, normal));
    }
  });
  if (n_bone_side > 0) add_layer(surface, n_bone_side, evidence);
  return evidence;
}

}  // namespace coxa::segment
