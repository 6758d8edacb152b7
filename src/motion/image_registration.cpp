#include <coxa/core/error.h>
#include <coxa/geom/cross_matrix.h>
#include <coxa/geom/fits.h>
#include <coxa/motion/calibration.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace coxa::motion {

namespace {

// covariance of the place of p when every landmark is off by sd: the fit's shift, and its turn
// times the arm from the landmarks' middle
Mat3 transferred_covariance(const Points& landmarks, const Vec3& p, double sd) {
  const Vec3 middle = landmarks.colwise().mean();
  Mat3 information = Mat3::Zero();
  for (Eigen::Index k = 0; k < landmarks.rows(); ++k) {
    const Mat3 arm = cross_matrix(landmarks.row(k).transpose() - middle);
    information += arm.transpose() * arm;
  }
  const Mat3 lever = cross_matrix(p - middle);
  return sd * sd *
         (Mat3::Identity() / static_cast<double>(landmarks.rows()) +
          lever * information.inverse() * lever.transpose());
}

}  // namespace

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

JointCentre registered_centre(const ImagedPelvis& image,
                              const std::map<std::string, Vec3>& in_pelvis, double marker_sd) {
  std::map<std::string, Vec3> in_image = image.landmarks;
  if (in_image.contains("psis_left") && in_image.contains("psis_right"))
    in_image["mid_psis"] = 0.5 * (in_image.at("psis_left") + in_image.at("psis_right"));
  const Registration registration = register_image(in_image, in_pelvis);
  std::vector<Vec3> used;
  for (const auto& [label, p] : in_image) {
    if (in_pelvis.contains(label)) used.push_back(p);
  }
  Points landmarks(static_cast<Eigen::Index>(used.size()), 3);
  for (std::size_t k = 0; k < used.size(); ++k)
    landmarks.row(static_cast<Eigen::Index>(k)) = used[k];
  // six of the 3n residuals are used up by the fit
  const auto n = static_cast<double>(used.size());
  const double seen_sd = registration.rms * std::sqrt(n / (3.0 * n - 6.0));
  const double sd = std::max(seen_sd, std::hypot(image.landmark_sd, marker_sd));
  const Mat3 covariance = transferred_covariance(landmarks, image.joint_centre, sd);
  JointCentre result;
  result.definition = "surfaces";
  result.centre = registration.X_PI * image.joint_centre;
  result.rms = registration.rms;
  result.interval =
      1.96 * std::hypot(image.joint_centre_sd, std::sqrt(covariance.diagonal().maxCoeff()));
  result.region = join_text("surfaces, laid on the markers by ", used.size(), " pelvis landmarks");
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
