#pragma once

#include <coxa/image/phantom.h>

#include <vector>

namespace coxa {

/// Everything around the given surfaces: muscles parted by fat, subcutaneous fat, skin, air.
class PhantomBody {
 public:
  PhantomBody(const PhantomOptions& options, const Vec3& body_centre);

  /// The same body with only those muscles that can matter within `reach` mm of `centre`: faster.
  PhantomBody near(const Vec3& centre, double reach) const;
  /// Mean signal around LPS p; edges are softened over `width` mm, the size of a voxel.
  Signal signal(const Vec3& p, double width) const;

 private:
  /// A spindle: ellipsoid of revolution.
  struct Spindle {
    Vec3 centre, axis;
    double radius, half_length;
    double fibre_signal;  ///< of its own, relative to mean muscle
  };
  struct Place {
    double muscle;  ///< share in [0, 1], the rest is fat
    double fibre_signal;
  };
  static double depth_in(const Spindle& spindle, const Vec3& p);
  Vec3 bent(const Vec3& p) const;
  Place inside_body(const Vec3& p, double width) const;
  double depth_below_skin(const Vec3& p) const;

  PhantomOptions options_;
  Vec3 body_centre_;
  std::vector<Spindle> spindles_;
  Signal muscle_, fat_, skin_;
};

/// Relative shading of a receiver coil at LPS p: 1 + bias f(p), f smooth with |f| <= 1.
class CoilShading {
 public:
  CoilShading(double bias, const Vec3& centre, double half_width, std::uint64_t seed);
  double operator()(const Vec3& p) const;

 private:
  double half_width_;
  Vec3 centre_, slope_;
  Mat3 curvature_;
};

}  // namespace coxa
