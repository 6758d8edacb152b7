#include "phantom_body.h"

#include <coxa/core/rng.h>

#include "smooth_noise.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace coxa {
namespace {

constexpr double kSkin = 2.0;      ///< mm
constexpr double kSpacing = 30.0;  ///< mm between the spindles' axes, before jitter
constexpr double kSeptum = 1.2;    ///< mm of fat between muscles
constexpr double kBend = 7.0;      ///< mm, standard deviation of the bending of muscles and skin

/// 1 deep below an edge at 0, 0 well above, linear over `width`.
double coverage(double depth, double width) { return std::clamp(0.5 + depth / width, 0.0, 1.0); }

Signal mix(const Signal& a, const Signal& b, double share_of_b) {
  return {a.water + share_of_b * (b.water - a.water), a.fat + share_of_b * (b.fat - a.fat)};
}

}  // namespace

PhantomBody::PhantomBody(const PhantomOptions& options, const Vec3& body_centre)
    : options_(options),
      body_centre_(body_centre),
      muscle_(tissue_signal(Tissue::muscle, options.contrast)),
      fat_(tissue_signal(Tissue::fat, options.contrast)),
      skin_(tissue_signal(Tissue::skin, options.contrast)) {
  if (!options.muscles) return;
  Rng rng(options.seed ^ 0x5eedULL);
  const Vec2 reach = options.body_semi_axes;
  const double length = 0.5 * options.field_of_view.norm() + 80.0;
  // staggered levels of spindles that fill the body
  for (double z = -length; z <= length; z += 90.0) {
    for (double y = -reach[1]; y <= reach[1]; y += kSpacing) {
      for (double x = -reach[0]; x <= reach[0]; x += kSpacing) {
        Spindle spindle;
        spindle.centre = body_centre + Vec3(x + rng.uniform(-12, 12), y + rng.uniform(-12, 12),
                                            z + rng.uniform(-45, 45));
        const Vec3 tilt(rng.uniform(-0.7, 0.7), rng.uniform(-0.7, 0.7), 1.0);
        spindle.axis = tilt.normalized();
        spindle.radius = rng.uniform(10.0, 24.0);
        spindle.half_length = rng.uniform(50.0, 110.0);
        spindle.fibre_signal = rng.uniform(0.93, 1.07);
        spindles_.push_back(spindle);
      }
    }
  }
}

/// About the distance from p to the spindle's surface in mm, positive inside; changes by at most
/// 1 mm per mm.
double PhantomBody::depth_in(const Spindle& spindle, const Vec3& p) {
  const Vec3 v = p - spindle.centre;
  const double along = v.dot(spindle.axis);
  const double across = std::sqrt(std::max(0.0, v.squaredNorm() - along * along));
  return (1.0 - std::hypot(across / spindle.radius, along / spindle.half_length)) * spindle.radius;
}

PhantomBody PhantomBody::near(const Vec3& centre, double reach) const {
  PhantomBody body = *this;
  // bending changes distances by less than a factor of two; fat is drawn out to 6 mm from a muscle
  const Vec3 middle = bent(centre);
  std::erase_if(body.spindles_, [&](const Spindle& spindle) {
    return depth_in(spindle, middle) < -(6.0 + 2.0 * reach);
  });
  return body;
}

PhantomBody::Place PhantomBody::inside_body(const Vec3& p, double width) const {
  // the two spindles that p lies deepest in part with a septum where they are equally deep
  double first = -kInfinity, second = -kInfinity, fibre_signal = 1.0;
  for (const Spindle& spindle : spindles_) {
    const double depth = depth_in(spindle, p);
    if (depth > first) {
      second = first;
      first = depth;
      fibre_signal = spindle.fibre_signal;
    } else {
      second = std::max(second, depth);
    }
  }
  const double septum = 0.5 * (first - second) - 0.5 * kSeptum;
  return {coverage(std::min(first, septum), width), fibre_signal};
}

double PhantomBody::depth_below_skin(const Vec3& p) const {
  const Vec3 v = p - body_centre_;
  const Vec2 q(v[0] / options_.body_semi_axes[0], v[1] / options_.body_semi_axes[1]);
  const double r = q.norm();
  if (r < 1e-6) return options_.body_semi_axes.minCoeff();
  // along the ray from the body's axis
  return v.head<2>().norm() * (1.0 / r - 1.0);
}

Vec3 PhantomBody::bent(const Vec3& p) const {
  Vec3 bend;
  for (int a = 0; a < 3; ++a) {
    bend[a] = smooth_noise(p, 55.0, options_.seed + 11 + static_cast<std::uint64_t>(a));
  }
  return p + kBend * bend;
}

Signal PhantomBody::signal(const Vec3& p, double width) const {
  const Vec3 q = bent(p);
  const double depth = depth_below_skin(q);
  const double body = coverage(depth, width);
  if (body <= 0.0) return {};
  const double deep = coverage(depth - options_.subcutaneous_fat, width);
  Signal inner = fat_;
  if (deep > 0.0) {
    const Place place = inside_body(q, width);
    const Signal fibres{place.fibre_signal * muscle_.water, place.fibre_signal * muscle_.fat};
    inner = mix(fat_, fibres, deep * place.muscle);
  }
  return mix({}, mix(skin_, inner, coverage(depth - kSkin, width)), body);
}

CoilShading::CoilShading(double bias, const Vec3& centre, double half_width, std::uint64_t seed)
    : half_width_(half_width), centre_(centre) {
  Rng rng(seed);
  slope_ = rng.normal3();
  Mat3 random;
  for (int r = 0; r < 3; ++r) random.row(r) = rng.normal3();
  curvature_ = 0.25 * (random + random.transpose());
  // scaled by the largest value on the cube of the half width
  double largest = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 q(n % 10 / 4.5 - 1.0, n / 10 % 10 / 4.5 - 1.0, n / 100 / 4.5 - 1.0);
    largest = std::max(largest, std::abs(slope_.dot(q) + q.dot(curvature_ * q)));
  }
  slope_ *= bias / largest;
  curvature_ *= bias / largest;
}

double CoilShading::operator()(const Vec3& p) const {
  const Vec3 q = (p - centre_) / half_width_;
  return 1.0 + slope_.dot(q) + q.dot(curvature_ * q);
}

}  // namespace coxa
