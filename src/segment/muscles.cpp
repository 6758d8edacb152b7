#include <coxa/segment/muscles.h>

#include <coxa/geom/thin_plate_spline.h>
#include <coxa/segment/tissue_warp.h>

#include <algorithm>

#include "preparation.h"
#include "schedule.h"
#include "stages.h"

namespace coxa::segment {
namespace {

/// Points of each bone that carry: enough for its form.
constexpr Index kControls = 250;
/// mm, as the atlas was built.
constexpr double kSmoothness = 20.0;
/// mm. Muscles differ more than few examples show: by this much over long and short lengths.
constexpr double kLongDeviation = 5.0, kShortDeviation = 2.0;
/// mm, of the places where the common displacement brings them.
constexpr double kPlaceNoise = 2.0;

/// Where the bones carry the muscles, all moved together to what looks like muscle in the first
/// image.
std::vector<Points> placed_muscles(const std::vector<const shape::StructureModel*>& models,
                                   const std::vector<FoundBone>& bones, const PreparedImage& image,
                                   const Monitor& monitor) {
  std::vector<Points> carried;
  std::vector<TriMesh> surfaces, obstacles;
  for (const shape::StructureModel* model : models) {
    SimplexMesh mesh = model->hierarchy.levels.back();
    mesh.points = carried_by_bones(mesh.points, bones);
    carried.push_back(mesh.points);
    surfaces.push_back(dual_surface(mesh));
  }
  for (const FoundBone& bone : bones) obstacles.push_back(bone.found);
  return moved_to_tissue(surfaces, obstacles, image, carried, {}, monitor);
}

}  // namespace

Points carried_by_bones(const Points& points, const std::vector<FoundBone>& bones) {
  std::vector<Vec3> from, to;
  for (const FoundBone& bone : bones) {
    const Index stride = std::max<Index>(1, bone.mean.n_vertices() / kControls);
    for (Index v = 0; v < bone.mean.n_vertices(); v += stride) {
      from.push_back(bone.mean.points.row(v).transpose());
      to.push_back(bone.found.points.row(v).transpose());
    }
  }
  Points a(from.size(), 3), b(to.size(), 3);
  for (std::size_t i = 0; i < from.size(); ++i) {
    a.row(static_cast<Index>(i)) = from[i].transpose();
    b.row(static_cast<Index>(i)) = to[i].transpose();
  }
  return ThinPlateSpline(a, b, kSmoothness)(points);
}

std::vector<Body> found_muscles(const std::vector<const shape::StructureModel*>& models,
                                const std::vector<FoundBone>& bones,
                                const std::vector<PreparedImage>& images,
                                const SegmentOptions& options, const Monitor& monitor) {
  std::vector<Points> placed =
      placed_muscles(models, bones, images.front(), part_of(monitor, "segment", 0.0, 0.3));
  std::vector<Preparation> preparations;
  for (const shape::StructureModel* model : models)
    preparations.push_back(prepared(*model, kLongDeviation, kShortDeviation));
  std::vector<Body> muscles(models.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    muscles[m].model = models[m];
    muscles[m].prepared = &preparations[m];
    muscles[m].fit = fit_model(*models[m], placed[m], VecX::Ones(placed[m].rows()), kPlaceNoise,
                               &preparations[m].smooth);
    muscles[m].points = std::move(placed[m]);
  }
  Obstacles firm;
  for (const FoundBone& bone : bones) firm.push_back(bone.found);
  update_through(muscles, muscle_resolutions(), images,
                 std::vector<Obstacles>(muscles.size(), firm), std::vector<TriMesh>(muscles.size()),
                 options, part_of(monitor, "segment", 0.3, 1.0));
  for (Body& body : muscles) body.prepared = nullptr;
  return muscles;
}

}  // namespace coxa::segment
