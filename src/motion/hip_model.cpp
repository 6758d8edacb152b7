#include <coxa/motion/hip_model.h>

#include <coxa/core/error.h>

#include <Eigen/SVD>

namespace coxa::motion {
namespace {

void check_markers(const std::map<std::string, Vec3>& markers, const char* bone) {
  require(markers.size() >= 3, "the model has ", markers.size(), " markers on the ", bone,
          "; at least 3 are needed");
  Points points(static_cast<Eigen::Index>(markers.size()), 3);
  Eigen::Index row = 0;
  for (const auto& [label, position] : markers) {
    require(position.allFinite(), "the position of marker ", label, " on the ", bone,
            " is not finite");
    points.row(row++) = position;
  }
  const Points centred = points.rowwise() - points.colwise().mean();
  const VecX spread = Eigen::JacobiSVD<MatX>(centred).singularValues();
  require(spread[1] > 1.0, "the markers on the ", bone,
          " lie on one line (or at one point); no rotation can be found from them");
}

}  // namespace

void check_model(const HipModel& model) {
  check_markers(model.pelvis_markers, "pelvis");
  check_markers(model.thigh_markers, "thigh");
  require(model.joint_centre_pelvis.allFinite() && model.joint_centre_femur.allFinite(),
          "the model's joint centre is not finite");
  require(model.marker_sd >= 0 && model.pelvis_centre_sd >= 0 && model.femur_centre_sd >= 0,
          "the model's standard deviations must not be negative");
}

}  // namespace coxa::motion
