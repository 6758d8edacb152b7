#include <coxa/shape/socket_rim.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/fits.h>
#include <coxa/geom/median.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/vertex_normals.h>

#include <algorithm>
#include <cmath>

namespace coxa::shape {
namespace {

// hours looked at: every 2 degrees
constexpr int kHours = 180;
// rad: heights looked at, and their step
constexpr double kLow = 0.6, kHigh = 2.3, kStep = 0.004;
// mm beyond the socket's surface where what a ray meets is still its wall
constexpr double kWall = 9.0;
// rad: cartilage that ends farther below the edge than this is a horn's end or the floor's border
constexpr double kCoveredWithin = 0.7;
// hours (2 degrees each) over which the edge is evened: about 2.5 mm
constexpr double kEvened = 3.0;
constexpr int kAxisRounds = 4;
// samples of a wall (by kStep) that say where its sphere lies: 0.36 rad, the outer third left out,
// for it may have begun to turn away; mm by which a shoulder has left it
constexpr std::size_t kWallSamples = 90;
constexpr double kShoulder = 2.0;

/// Points of the surface that look at the place.
Points facing(const TriMesh& mesh, const Vec3& place) {
  const Points normals = vertex_normals(mesh);
  std::vector<Index> rows;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 to = place - mesh.points.row(v).transpose();
    if (normals.row(v).dot(to) > 0.7 * to.norm()) rows.push_back(v);
  }
  return mesh.points(rows, Eigen::all);
}

int wrapped(int i) { return ((i % kHours) + kHours) % kHours; }
double hour_of(int i) { return 12.0 * i / kHours; }

/// NaN where no value is known.
double median_of_known(std::vector<double> values) {
  std::erase_if(values, [](double v) { return v != v; });
  if (values.empty()) return kNaN;
  return median(values);
}

/// Heights at which a ray from the centre is asked how far the surface is, and the answers (NaN:
/// nowhere near).
std::vector<double> wall(const TriangleTree& tree, const SocketRim& rim, double hour) {
  std::vector<double> distances;
  for (double h = kLow; h <= kHigh; h += kStep) {
    const auto hit = tree.first_hit(rim.clock.centre, rim.direction(hour, h), rim.radius + kWall);
    distances.push_back(hit ? hit->distance : kNaN);
  }
  return distances;
}

/// Where a wall ends: no ray farther out meets it, or it has left the sphere it follows farther in.
double end_of(const std::vector<double>& distances) {
  double last = kNaN;
  std::vector<double> before;
  for (std::size_t k = 0; k < distances.size(); ++k) {
    const double h = kLow + kStep * static_cast<double>(k);
    if (distances[k] != distances[k]) {
      // a wall that has ended does not go on behind a gap (the spine above the socket)
      if (last == last && h - last > 10.0 * kStep) break;
      continue;
    }
    if (before.size() > kWallSamples) {
      const std::vector<double> along(before.end() - kWallSamples, before.end() - kWallSamples / 3);
      if (distances[k] > median_of_known(along) + kShoulder) break;
    }
    before.push_back(distances[k]);
    last = h;
  }
  return last;
}

std::vector<double> horizons(const TriMesh& mesh, const SocketRim& rim) {
  const TriangleTree tree(mesh.points, mesh.triangles);
  std::vector<double> heights(kHours);
  parallel_for(kHours, [&](Index i) {
    heights[static_cast<std::size_t>(i)] = end_of(wall(tree, rim, hour_of(i)));
  });
  return heights;
}

/// Where the cartilage's border is near the edge; runs shorter than half an hour are closed.
std::vector<bool> covered_hours(const SocketRim& rim) {
  const double usual = median_of_known(rim.height);
  std::vector<bool> covered(kHours);
  for (int i = 0; i < kHours; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double edge = rim.height[k] == rim.height[k] ? rim.height[k] : usual;
    covered[k] = rim.cartilage[k] == rim.cartilage[k] && rim.cartilage[k] > edge - kCoveredWithin;
  }
  return covered;
}

/// First hour and length of the longest stretch without cartilage.
std::pair<int, int> notch_of(const std::vector<bool>& covered) {
  std::pair<int, int> best{0, 0};
  for (int begin = 0; begin < kHours; ++begin) {
    if (covered[static_cast<std::size_t>(begin)]) continue;
    int length = 0;
    while (length < kHours && !covered[static_cast<std::size_t>(wrapped(begin + length))]) ++length;
    if (length > best.second) best = {begin, length};
  }
  return best;
}

/// Plane through the edge, out of the socket.
Vec3 axis_through(const SocketRim& rim) {
  std::vector<Vec3> places;
  for (int i = 0; i < kHours; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (rim.covered[k] && rim.height[k] == rim.height[k])
      places.push_back(rim.direction(hour_of(i), rim.height[k]));
  }
  require(places.size() > kHours / 4,
          "the socket's rim was not found: no hip bone about the cartilage");
  Points points(static_cast<Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) points.row(static_cast<Index>(i)) = places[i];
  const Vec3 normal = fit_plane(points).normal;
  return normal.dot(rim.clock.axis) > 0.0 ? normal : Vec3(-normal);
}

void update_horizons(SocketRim& rim, const TriMesh& hip_bone, const TriMesh& cartilage) {
  rim.height = horizons(hip_bone, rim);
  rim.cartilage = horizons(cartilage, rim);
  rim.covered = covered_hours(rim);
}

/// The heights evened along the rim where there is an edge beside cartilage; NaN elsewhere.
std::vector<double> evened(const std::vector<double>& heights, const std::vector<bool>& covered) {
  std::vector<double> result(kHours, kNaN);
  const int reach = static_cast<int>(3.0 * kEvened);
  for (int i = 0; i < kHours; ++i) {
    if (!covered[static_cast<std::size_t>(i)]) continue;
    double sum = 0.0, weight = 0.0;
    for (int d = -reach; d <= reach; ++d) {
      const auto k = static_cast<std::size_t>(wrapped(i + d));
      if (!covered[k] || heights[k] != heights[k]) continue;
      const double w = std::exp(-0.5 * d * d / (kEvened * kEvened));
      sum += w * heights[k];
      weight += w;
    }
    if (weight > 0.0) result[static_cast<std::size_t>(i)] = sum / weight;
  }
  return result;
}

/// Between the two nearest hours that have a value.
double between(const std::vector<double>& values, double hour) {
  const double place = hour / 12.0 * kHours;
  const int low = static_cast<int>(std::floor(place));
  int before = low, after = low + 1;
  for (int d = 0; d < kHours && values[static_cast<std::size_t>(wrapped(before))] !=
                                    values[static_cast<std::size_t>(wrapped(before))];
       ++d)
    --before;
  for (int d = 0; d < kHours && values[static_cast<std::size_t>(wrapped(after))] !=
                                    values[static_cast<std::size_t>(wrapped(after))];
       ++d)
    ++after;
  const double share = (place - before) / (after - before);
  return (1.0 - share) * values[static_cast<std::size_t>(wrapped(before))] +
         share * values[static_cast<std::size_t>(wrapped(after))];
}

}  // namespace

Vec3 SocketRim::direction(double hour, double h) const {
  const double turn = hour / 6.0 * kPi;
  const Vec3 across = std::cos(turn) * clock.twelve + std::sin(turn) * clock.three;
  return std::sin(h) * across - std::cos(h) * clock.axis;
}

double SocketRim::height_at(double hour) const { return between(height, hour); }

double SocketRim::cartilage_at(double hour) const {
  return std::min(between(cartilage, hour), height_at(hour));
}

SocketRim find_socket_rim(const TriMesh& hip_bone, const TriMesh& cartilage) {
  require(!hip_bone.empty() && !cartilage.empty(), "the socket's rim needs hip bone and cartilage");
  SocketRim rim;
  const SphereFitOptions robust{.outlier_scale = 4.7};
  Sphere sphere = fit_sphere(cartilage.points, {}, robust);
  const Points articular = facing(cartilage, sphere.centre);
  require(articular.rows() >= 20, "the acetabular cartilage does not enclose a joint centre");
  sphere = fit_sphere(articular, {}, robust);
  rim.radius = sphere.radius;
  const Vec3 superior = Vec3::UnitZ(), anterior = -Vec3::UnitY();
  Vec3 axis = sphere.centre - articular.colwise().mean().transpose();
  for (int round = 0; round < kAxisRounds; ++round) {
    rim.clock = make_clock_face(sphere.centre, axis, superior, anterior);
    update_horizons(rim, hip_bone, cartilage);
    axis = axis_through(rim);
  }
  // 6 o'clock is the notch's middle: another twelve, the same face
  const auto [begin, length] = notch_of(rim.covered);
  require(length > 0, "the acetabular cartilage has no notch: a ring is not a horseshoe");
  const Vec3 six = rim.direction(hour_of(begin) + 6.0 * length / kHours, kPi / 2.0);
  rim.clock = make_clock_face(sphere.centre, axis, -six, anterior);
  update_horizons(rim, hip_bone, cartilage);
  const auto [first, count] = notch_of(rim.covered);
  rim.notch_begin = hour_of(first) - 0.5 * hour_of(1);
  rim.notch_end = hour_of(first + count) - 0.5 * hour_of(1);
  rim.height = evened(rim.height, rim.covered);
  rim.cartilage = evened(rim.cartilage, rim.covered);
  return rim;
}

}  // namespace coxa::shape
