#include <coxa/shape/labrum.h>

#include <coxa/shape/carve.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/geom/triangle_tree.h>
#include <coxa/mesh/iso_surface.h>
#include <coxa/mesh/measures.h>
#include <coxa/mesh/validate.h>
#include <coxa/shape/ligaments.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/shapes.h"

namespace coxa::shape {

/// Surface of where `inside` is positive, from samples 1.25 mm apart in a cube about the origin.
TriMesh body(double half, const std::function<double(const Vec3&)>& inside) {
  const auto n = static_cast<Index>(2.0 * half / 1.25) + 1;
  const auto place = [&](const Vec3& index) -> Vec3 { return 1.25 * index.array() - half; };
  std::vector<float> values;
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        values.push_back(static_cast<float>(inside(place(Vec3(i, j, k)))));
  return iso_surface({n, n, n}, values, 0.0, place);
}

/// A right socket that opens laterally, the notch below: bone, a horseshoe of cartilage and a head.
class Socket : public ::testing::Test {
 protected:
  static double notch(const Vec3& p) {  // positive outside of it
    return p.z() < 0.0 ? std::abs(p.y()) - 9.0 : 1e3;
  }
  struct Parts {
    TriMesh bone = body(40.0, [](const Vec3& p) {
      return std::min({38.0 - p.norm(), p.norm() - 26.0, p.x() + 2.0, notch(p)});
    });
    TriMesh cartilage = body(32.0, [](const Vec3& p) {
      const double off_pole = std::hypot(p.y(), p.z()) - 12.0;
      return std::min({25.9 - p.norm(), p.norm() - 24.0, p.x() - 1.0, notch(p) - 1.0, off_pole});
    });
    TriMesh head = body(30.0, [](const Vec3& p) { return 23.8 - p.norm(); });
    SocketRim rim = find_socket_rim(bone, cartilage);
    TriMesh labrum = make_labrum(rim, bone, cartilage, {head});
  };
  static const Parts& parts() {
    static const Parts made;
    return made;
  }
  const TriMesh &bone_ = parts().bone, &cartilage_ = parts().cartilage, &head_ = parts().head,
                &labrum_ = parts().labrum;
  const SocketRim& rim_ = parts().rim;
};

double deepest(const TriMesh& mesh, const TriMesh& other) {
  const TriangleTree tree(other.points, other.triangles);
  double least = kInfinity;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    least = std::min(least, tree.signed_distance(mesh.points.row(v).transpose()));
  return -least;
}

TEST_F(Socket, HasItsEdgeWhereTheBoneEndsAndSixInTheNotch) {
  EXPECT_LT(rim_.clock.centre.norm(), 0.5);
  EXPECT_NEAR(rim_.radius, 24.0, 0.5);
  EXPECT_GT(rim_.clock.axis.dot(-Vec3::UnitX()), 0.99);  // a right hip's sockets open to -x
  EXPECT_GT(rim_.clock.twelve.z(), 0.98);
  EXPECT_GT(rim_.clock.three.dot(-Vec3::UnitY()), 0.98);
  EXPECT_NEAR(0.5 * (rim_.notch_begin + rim_.notch_end), 6.0, 0.1);
  // the edge lies 2 mm before the equator of a sphere of 26 mm
  EXPECT_NEAR(degrees(rim_.height_at(0.0)), 90.0 + degrees(std::asin(2.0 / 26.0)), 1.5);
}
TEST_F(Socket, LabrumIsClosedAndOutOfEverything) {
  EXPECT_TRUE(validate(labrum_).valid()) << validate(labrum_).text();
  for (const TriMesh* other : {&bone_, &cartilage_, &head_})
    EXPECT_LT(deepest(labrum_, *other), 0.0);
}
TEST_F(Socket, LabrumStandsAsFarOutAsPublished) {
  double anterior = 0.0, posterior = 0.0;
  for (Index v = 0; v < labrum_.n_vertices(); ++v) {
    const Vec3 p = labrum_.points.row(v);
    const double hour = rim_.clock.hour(p), out = -p.x() - 2.0;
    if (std::abs(hour - 3.0) < 0.3) anterior = std::max(anterior, out);
    if (std::abs(hour - 9.0) < 0.3) posterior = std::max(posterior, out);
  }
  EXPECT_NEAR(anterior, labrum_height(3.0), 0.8);
  EXPECT_NEAR(posterior, labrum_height(9.0), 0.8);
  EXPECT_DOUBLE_EQ(labrum_height(3.0), 7.4);
  EXPECT_DOUBLE_EQ(labrum_height(0.0), labrum_height(12.0));
}
TEST_F(Socket, TransverseLigamentBridgesTheNotchWithoutTouchingTheLabrum) {
  const TriMesh bridge = make_transverse_ligament(rim_, bone_, cartilage_, {head_});
  EXPECT_TRUE(validate(bridge).valid()) << validate(bridge).text();
  for (const TriMesh* other : {&bone_, &cartilage_, &head_, &labrum_})
    EXPECT_LT(deepest(bridge, *other), 0.0);
  EXPECT_LT(bridge.points.col(1).minCoeff(), -5.0);
  EXPECT_GT(bridge.points.col(1).maxCoeff(), 5.0);
  EXPECT_LT(bridge.points.col(2).maxCoeff(), 0.0);
}
TEST_F(Socket, LabrumIsTheSameForOneAndEightThreads) {
  set_thread_count(1);
  const TriMesh one = make_labrum(rim_, bone_, cartilage_, {head_}, {.spacing = 4.0});
  set_thread_count(8);
  EXPECT_EQ(one.points, make_labrum(rim_, bone_, cartilage_, {head_}, {.spacing = 4.0}).points);
}
TEST(Carved, LeavesWhatLiesOutOfTheOthersAndIsNearlyTheExactVolume) {
  const TriMesh ball = test::icosphere(3, 10.0);
  const TriMesh other = test::moved(test::icosphere(3, 10.0), {Mat3::Identity(), Vec3(12, 0, 0)});
  const TriMesh rest = carved(ball, {&other}, {.gap = 0.2, .spacing = 0.6});
  EXPECT_TRUE(validate(rest).valid()) << validate(rest).text();
  EXPECT_LT(deepest(rest, other), 0.0);
  // less the lens: two caps of the spheres, one of them larger by the gap
  const auto cap = [](double r, double h) { return kPi * h * h * (3.0 * r - h) / 3.0; };
  const double middle = (144.0 + 100.0 - 10.2 * 10.2) / 24.0;  // of their common circle, along x
  const double lens = cap(10.0, 10.0 - middle) + cap(10.2, 10.2 - (12.0 - middle));
  EXPECT_NEAR(volume(rest), volume(ball) - lens, 0.015 * volume(ball));
}
TEST(Carved, StaysAsItIsWhereNothingIsInTheWayAndSaysWhereLittleIsLeft) {
  const TriMesh ball = test::icosphere(3, 10.0);
  const TriMesh far = test::moved(ball, {Mat3::Identity(), Vec3(25, 0, 0)});
  EXPECT_EQ(carved(ball, {&far}).points, ball.points);
  const TriMesh near = test::moved(ball, {Mat3::Identity(), Vec3(5, 0, 0)});
  EXPECT_THROW(carved(ball, {&near}), Error);
}
TEST_F(Socket, WithoutANotchIsNoSocket) {
  try {
    find_socket_rim(bone_, body(32.0, [](const Vec3& p) {
                      return std::min({25.9 - p.norm(), p.norm() - 24.0, p.x() - 1.0});
                    }));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("notch"), std::string::npos);
  }
}
TEST_F(Socket, ABandGoesAroundTheHeadInsteadOfThroughIt) {
  LigamentSite site{"band", 3.0, {}, {}};
  for (int j = 0; j < 5; ++j) {
    const double y = 2.0 * j - 4.0;
    site.origin.push_back({Vec3(20.0, y, 38.0), Vec3(10.0, y, 38.0)});
    site.insertion.push_back({Vec3(-30.0, y, -10.0), Vec3(-32.0, y, -14.0)});
  }
  const TriMesh band = make_ligament(site, Vec3::Zero(), {head_});
  EXPECT_TRUE(validate(band).valid()) << validate(band).text();
  EXPECT_LT(deepest(band, head_), 0.0);
  // tight: the middle lies on the head, as thick as the band
  double nearest = kInfinity, farthest = 0.0;
  for (Index v = 0; v < band.n_vertices(); ++v) {
    const Vec3 p = band.points.row(v);
    if (std::abs(p.y()) > 3.0 || std::abs(std::atan2(p.z(), -p.x()) - 0.9) > 0.15) continue;
    nearest = std::min(nearest, p.norm());
    farthest = std::max(farthest, p.norm());
  }
  EXPECT_NEAR(nearest, 23.9, 0.3);
  EXPECT_NEAR(farthest - nearest, 3.0, 0.3);
}

}  // namespace coxa::shape
