#include "schedule.h"

namespace coxa::segment {
namespace {

/// mm. Landmarks place what is this near to within the search's range; a shaft's far end is off by
/// more.
constexpr double kFirstReach = 60.0;

}  // namespace

std::vector<Resolution> bone_resolutions(double range) {
  return {{.coarsening = 3,
           .range = range,
           .image_sigma = 1.5,
           .window = 2.5,
           .affine_k = 0.0,
           .level_share = 0.3,
           .score_smoothing = 12,
           .model_noise = 3.0,
           .first_reach = kFirstReach,
           .fit_only = true,
           .smooth = false},
          {.coarsening = 3,
           .range = range,
           .image_sigma = 1.0,
           .window = 2.0,
           .affine_k = 1.0,
           .level_share = 0.5,
           .score_smoothing = 10,
           .model_noise = 2.0,
           .first_reach = kFirstReach,
           .fit_only = true},
          {.coarsening = 3,
           .range = 0.6 * range,
           .image_sigma = 1.0,
           .window = 2.0,
           .affine_k = 0.5,
           .level_share = 0.3,
           .score_smoothing = 10,
           .model_noise = 2.0},
          {.coarsening = 2,
           .range = 0.4 * range,
           .image_sigma = 0.7,
           .window = 1.5,
           .affine_k = 0.85,
           .level_share = 0.5,
           .score_smoothing = 8,
           .model_noise = 1.0},
          {.coarsening = 1,
           .range = 0.25 * range,
           .image_sigma = 0.4,
           .window = 1.5,
           .affine_k = 1.0,
           .level_share = 0.7,
           .score_smoothing = 5,
           .model_noise = 0.7},
          {.coarsening = 0,
           .range = 0.15 * range,
           .window = 1.5,
           .score_smoothing = 2,
           .model_noise = 0.5}};
}

std::vector<Resolution> layer_resolutions() {
  return {{.coarsening = 1,
           .range = 2.5,
           .image_sigma = 0.4,
           .window = 2.0,
           .affine_k = 0.7,
           .level_share = 0.5,
           .score_smoothing = 5,
           .model_noise = 0.7},
          {.coarsening = 0, .range = 1.5, .window = 1.5, .score_smoothing = 2, .model_noise = 0.5}};
}

std::vector<Resolution> muscle_resolutions() {
  return {{.coarsening = 1,
           .range = 4.0,
           .image_sigma = 1.0,
           .window = 2.0,
           .affine_k = 0.8,
           .level_share = 0.5,
           .score_smoothing = 8,
           .model_noise = 2.0},
          {.coarsening = 0,
           .range = 2.0,
           .image_sigma = 0.5,
           .window = 1.5,
           .score_smoothing = 3,
           .model_noise = 1.0}};
}

}  // namespace coxa::segment
