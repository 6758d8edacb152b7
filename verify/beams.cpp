// Slender cantilevers against the elastica (inextensible, shear-free rod; nu = 0): theta is the
// tip's angle.
#include <coxa/core/error.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/integrators.h>
#include <coxa/fem/elastic_force.h>
#include <coxa/fem/loads.h>

#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

constexpr double kLength = 100.0, kSide = 1.0, kModulus = 1000.0;
constexpr double kBending = kModulus * kSide * kSide * kSide * kSide / 12.0;

/// One line of a table of the rod: load factor, then tip angle in degrees, x / L and w / L.
struct Deflection {
  double load, angle_deg, x, w;
};

class Cantilever {
 public:
  Cantilever()
      : mesh_(rod_mesh()),
        elastic_(mesh_, fem::make_st_venant_kirchhoff(fem::lame_from(kModulus, 0.0))),
        particles_{fem::test::stacked(mesh_.points), VecX::Zero(mesh_.points.size()),
                   VecX::Ones(mesh_.n_vertices())} {
    for (Index i = 0; i < mesh_.n_vertices(); ++i) {
      if (mesh_.points(i, 0) < 1e-9) constraints_.hold(i);
      if (mesh_.points(i, 0) > kLength - 1e-9) tip_.push_back(i);
    }
  }

  const TetMesh& mesh() const { return mesh_; }
  const std::vector<Index>& tip() const { return tip_; }

  /// Moves to equilibrium under a dead load, from where it is.
  Deflection bend(const VecX& load, double factor) {
    const dynamics::ConstantForce weight(load);
    const SolveReport report = dynamics::update_relax(
        particles_, {&elastic_, &weight}, constraints_,
        {.tolerance = 1e-9, .max_iterations = 200, .linear_solver = dynamics::LinearSolver::ldlt});
    if (!report.converged) fail(ErrorCode::no_convergence, "cantilever: ", report.reason);
    return measure(factor);
  }

 private:
  /// The centre of the end face, and the turn of its middle line, which stays normal to the rod.
  Deflection measure(double factor) const {
    const auto at = [&](double y, double z) {
      for (const Index i : tip_)
        if (std::abs(mesh_.points(i, 1) - y) + std::abs(mesh_.points(i, 2) - z) < 1e-9)
          return Vec3(particles_.position(i));
      fail(ErrorCode::bad_mesh, "no node on the end face at ", y, ", ", z);
    };
    const Vec3 centre = at(0.5, 0.5), up = at(0.5, 1.0) - at(0.5, 0.0);
    return {factor, degrees(std::atan2(up[0], up[2])), centre[0] / kLength,
            (0.5 * kSide - centre[2]) / kLength};
  }

  TetMesh mesh_;
  fem::ElasticForce elastic_;
  dynamics::Particles particles_;
  dynamics::Constraints constraints_;
  std::vector<Index> tip_;
};

void add_rows(Rows& rows, const std::string& name, const Deflection& known,
              const Deflection& ours) {
  constexpr double kTolerance = 0.005;
  const std::string load = join_text(name, " = ", known.load, ": ");
  if (known.angle_deg > 0.0)
    rows.push_back({load + "tip angle, degrees", known.angle_deg, ours.angle_deg, kTolerance,
                    "tip angle, degrees", known.load});
  if (known.x > 0.0)
    rows.push_back({load + "x / L", known.x, ours.x, kTolerance, "x / L", known.load});
  rows.push_back({load + "w / L", known.w, ours.w, kTolerance, "w / L", known.load});
}

}  // namespace

TetMesh rod_mesh() {
  constexpr Index kCells = 60;
  return quadratic_mesh({kCells, 1, 1, [](Index i, Index j, Index k) {
                           return Vec3(kLength * i / kCells, kSide * j, kSide * k);
                         }});
}

Rows elastica() {
  // a = P L^2 / (E I); table of the elastica by elliptic integrals
  const std::vector<Deflection> table{{0.1, 2.862, .99934, .03330},  {0.25, 7.121, .99588, .08275},
                                      {0.5, 14.011, .98408, .16214}, {1, 26.434, .94357, .30172},
                                      {2, 44.791, .83936, .49346},   {3, 56.495, .74558, .60325},
                                      {4, 64.242, .67106, .66996},   {5, 69.635, .61237, .71379},
                                      {7.5, 77.689, .51043, .77670}, {10, 81.949, .44500, .81061}};
  Cantilever rod;
  Rows rows;
  for (const Deflection& known : table) {
    VecX load = VecX::Zero(rod.mesh().points.size());
    const double total = known.load * kBending / (kLength * kLength);
    for (const Index i : rod.tip())
      load[3 * i + 2] = -total / static_cast<double>(rod.tip().size());
    add_rows(rows, "P L^2/EI", known, rod.bend(load, known.load));
  }
  return rows;
}

Rows self_weight() {
  // b = q L^3 / (E I); shooting solution of the heavy elastica
  const std::vector<Deflection> table{{0.5, 0, 0, .06231},         {1, 9.460, .99125, .12347},
                                      {2, 18.426, .96689, .23851}, {4, 33.724, .89011, .42516},
                                      {8, 53.865, .72443, .64063}, {16, 72.207, .51000, .79702},
                                      {32, 83.730, .32849, .87846}};
  Cantilever rod;
  Rows rows;
  for (const Deflection& known : table) {
    const double density = known.load * kBending / (kLength * kLength * kLength) / (kSide * kSide);
    const VecX load = fem::body_load(rod.mesh(), Vec3(0, 0, -density));
    add_rows(rows, "q L^3/EI", known, rod.bend(load, known.load));
  }
  return rows;
}

}  // namespace coxa::verify
