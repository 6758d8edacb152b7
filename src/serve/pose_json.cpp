#include "pose_json.h"

namespace coxa::serve {

nlohmann::json json_of(const RigidTransform& X) {
  nlohmann::json numbers = nlohmann::json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) numbers.push_back(X.R(r, c));
  }
  for (int r = 0; r < 3; ++r) numbers.push_back(X.p[r]);
  return numbers;
}

}  // namespace coxa::serve
