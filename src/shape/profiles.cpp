#include <coxa/shape/profiles.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>

#include <cmath>
#include <optional>

namespace coxa::shape {
namespace {

// a profile whose samples vary by less than this share of their mean has no border in it
constexpr double kFlatShare = 0.02;

/// Samples along the normal, mean 0 and norm 1; nullopt outside the image or where flat.
std::optional<VecX> normalised_profile(const Volume& image, const Vec3& p, const Vec3& n,
                                       const ProfileOptions& options) {
  VecX samples(options.n_inside + 1 + options.n_outside);
  for (Index k = 0; k < samples.size(); ++k) {
    samples[k] = sample(image, p + (k - options.n_inside) * options.step * n);
    if (!(samples[k] == samples[k])) return std::nullopt;
  }
  const double mean = samples.mean();
  samples.array() -= mean;
  const double norm = samples.norm();
  if (norm <= kFlatShare * std::abs(mean) * std::sqrt(static_cast<double>(samples.size())))
    return std::nullopt;
  return VecX(samples / norm);
}

}  // namespace

ProfileSet learn_profiles(const std::vector<ProfileExample>& examples, const std::string& contrast,
                          const ProfileOptions& options) {
  require(!examples.empty(), "profiles need at least one example image");
  require(options.step > 0.0 && options.n_inside >= 1 && options.n_outside >= 1,
          "profile step and sample counts must be positive");
  const Index n = static_cast<Index>(examples.front().points.rows());
  for (const ProfileExample& e : examples) {
    require(e.points.rows() == n && e.normals.rows() == n,
            "profile examples differ in their number of vertices: ", e.points.rows(), " and ", n);
  }
  ProfileSet set;
  set.contrast = contrast;
  set.step = options.step;
  set.n_inside = options.n_inside;
  set.mean = MatX::Zero(n, options.n_inside + 1 + options.n_outside);
  set.reliability = VecX::Zero(n);
  parallel_for(n, [&](Index v) {
    Index count = 0;
    for (const ProfileExample& e : examples) {
      const auto profile = normalised_profile(*e.image, e.points.row(v), e.normals.row(v), options);
      if (!profile) continue;
      set.mean.row(v) += profile->transpose();
      ++count;
    }
    const double length = set.mean.row(v).norm();
    if (count == 0 || length <= 0.0) return;
    set.reliability[v] = length / count;
    set.mean.row(v) /= length;
  });
  return set;
}

ProfileExample profile_example(const StructureModel& model, const TriMesh& surface,
                               const Volume& image) {
  SimplexMesh mesh = model.hierarchy.levels.back();
  require(surface.triangles == mesh.faces_of, "the ", model.name,
          " of a hip has other triangles than the atlas");
  mesh.points = make_simplex_mesh(surface).points;
  return {&image, mesh.points, simplex_normals(mesh)};
}

void update_profiles(Atlas& atlas, const std::vector<ImagedHip>& hips,
                     const ProfileOptions& options) {
  for (StructureModel& model : atlas.structures) {
    if (model.muscle) continue;
    std::map<std::string, std::vector<ProfileExample>> by_contrast;
    for (const ImagedHip& hip : hips)
      by_contrast[hip.contrast].push_back(
          profile_example(model, hip.surfaces->at(model.name), *hip.image));
    model.profiles.clear();
    for (const auto& [contrast, list] : by_contrast)
      model.profiles.push_back(learn_profiles(list, contrast, options));
  }
}

}  // namespace coxa::shape
