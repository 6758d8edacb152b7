#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/motion/calibration.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa::motion {

Registration register_image(const std::map<std::string, Vec3>& in_image,
                            const std::map<std::string, Vec3>& in_pelvis) {
  std::vector<Vec3> a, b;
  for (const auto& [label, p] : in_image) {
    const auto it = in_pelvis.find(label);
    if (it == in_pelvis.end()) continue;
    a.push_back(p);
    b.push_back(it->second);
  }
  require(a.size() >= 3, "only ", a.size(),
          " pelvis landmarks are known both in the image and on the markers; 3 are needed");
  Points from(static_cast<Eigen::Index>(a.size()), 3), to(from.rows(), 3);
  for (std::size_t k = 0; k < a.size(); ++k) {
    from.row(static_cast<Eigen::Index>(k)) = a[k];
    to.row(static_cast<Eigen::Index>(k)) = b[k];
  }
  Registration result;
  result.X_PI = fit_rigid(from, to);
  result.n_landmarks = static_cast<Index>(a.size());
  result.rms = std::sqrt((transformed(from, result.X_PI) - to).squaredNorm() /
                         static_cast<double>(a.size()));
  return result;
}

std::map<std::string, Vec3> pelvis_landmarks(const HipModel& model, const MarkerMap& map) {
  std::map<std::string, Vec3> landmarks;
  for (const MarkerRole role : {MarkerRole::asis_left, MarkerRole::asis_right,
                                MarkerRole::psis_left, MarkerRole::psis_right}) {
    const auto patterns = map.find(role);
    if (patterns == map.end()) continue;
    for (const auto& [label, p] : model.pelvis_markers) {
      const bool matches =
          std::any_of(patterns->second.begin(), patterns->second.end(),
                      [&](const std::string& pattern) { return label_matches(label, pattern); });
      if (matches) landmarks.emplace(name(role), p);
    }
  }
  return landmarks;
}

}  // namespace coxa::motion
