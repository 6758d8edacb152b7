// Biphasic cartilage pressed in a chamber (confined) or between plates (unconfined), over time.
#include <coxa/core/error.h>
#include <coxa/dynamics/forces.h>
#include <coxa/dynamics/system.h>
#include <coxa/fem/elastic_force.h>
#include <coxa/fem/flow_stepper.h>

#include <algorithm>
#include <cmath>

#include "cases.h"
#include "shapes.h"

namespace coxa::verify {
namespace {

constexpr double kHeight = 1.0, kWidth = 0.2;  // mm, of the confined column
constexpr double kSmall = 1e-5;                // a strain at which the theory is linear
constexpr double kGrowth = 1.02,
                 kFirst = 1e-7;  // of the time steps; the first, of the slowest time
const fem::Lame kSolid = fem::lame_from(0.7, 0.15);  // MPa
constexpr double kMobility = 2e-3;                   // mm⁴/(N s)

double aggregate_modulus() { return kSolid.lambda + 2.0 * kSolid.mu; }

/// A biphasic body with what holds and drives it.
struct Body {
  Body(TetMesh tets, const fem::Permeability& permeability)
      : mesh(std::move(tets)),
        fluid(mesh, permeability,
              {.pressure_unit = aggregate_modulus(),
               .stabilisation = mesh.mid_nodes.rows() > 0 ? 0.0 : 0.5 / kSolid.mu}),
        solid(mesh, fem::make_neo_hookean(kSolid)),
        x(fluid.reference()) {
    fluid.add_unused(constraints);
  }
  std::vector<Index> nodes_where(const std::function<bool(const Vec3&)>& chosen) const {
    std::vector<Index> nodes;
    for (Index i = 0; i < mesh.n_vertices(); ++i)
      if (chosen(mesh.points.row(i).transpose())) nodes.push_back(i);
    return nodes;
  }
  /// Force along z that nodes need, fluid and solid together, N.
  double force_on(const std::vector<Index>& nodes) const {
    VecX force = VecX::Zero(x.size());
    solid.add_force(x, VecX(), force);
    fluid.add_force(x, VecX(), force);
    double sum = 0.0;
    for (const Index i : nodes) sum += force[3 * i + 2];
    return sum;
  }

  TetMesh mesh;
  fem::PoreFluid fluid;
  fem::ElasticForce solid;
  dynamics::Constraints constraints;
  VecX x;
};

/// Steps that grow with the time since the last kink of the drive, ending at each of `times` (s,
/// ascending), where `at` is called. `drive` sets what is prescribed at the end of a step.
struct Course {
  double slowest;  // s, what times are compared with
  double reference_force;
  std::function<void(double)> drive;
  std::function<void(double)> at;
  double kink = 0.0;  // s, one of the times; 0: only the start
};
void follow(Body& body, std::vector<const dynamics::Force*> others,
            const std::vector<double>& times, const Course& course) {
  others.push_back(&body.solid);
  fem::FlowStepper stepper(body.fluid, others, body.x);
  double start = 0.0, kink = 0.0;
  for (const double end : times) {
    const bool afresh = start == kink;
    const double origin = afresh ? kFirst * course.slowest : start - kink;
    const int n = static_cast<int>(std::ceil(std::log((end - kink) / origin) / std::log(kGrowth)));
    double before = start;
    for (int k = afresh ? 0 : 1; k <= n; ++k) {
      const double share = static_cast<double>(k) / n;
      const double now = k == n ? end : kink + origin * std::pow((end - kink) / origin, share);
      course.drive(now);
      const SolveReport report = stepper.update_step(body.x, body.constraints,
                                                     {.time_step = now - before,
                                                      .tolerance = 1e-7,
                                                      .reference_force = course.reference_force});
      if (!report.converged) fail(ErrorCode::no_convergence, "biphasic body: ", report.reason);
      before = now;
    }
    course.at(end);
    start = end;
    if (end == course.kink) kink = end;
  }
}

/// A column in a smooth, sealed chamber, its top open; cells shrink towards the top.
struct Column : Body {
  Column(int nodes, const fem::Permeability& permeability)
      : Body(column_mesh(nodes), permeability),
        top(nodes_where([](const Vec3& X) { return X[2] > kHeight - 1e-9; })) {
    for (Index i = 0; i < mesh.n_vertices(); ++i) {
      Vec3 free = Vec3::Ones();
      for (int c = 0; c < 2; ++c)
        if (std::abs(mesh.points(i, c) - 0.5 * kWidth) > 0.5 * kWidth - 1e-9) free[c] = 0.0;
      if (mesh.points(i, 2) < 1e-9) free[2] = 0.0;
      if (free.sum() < 3.0) constraints.add(i, free.asDiagonal(), Vec3::Zero());
    }
    fluid.add_drained(top, constraints);
  }
  static TetMesh column_mesh(int nodes) {
    constexpr Index kCells = 16;
    const std::vector<double> z = graded(kHeight, kCells, 1.22);
    const TetMesh mesh = quadratic_mesh(
        {1, 1, kCells, [&](Index i, Index j, Index k) {
           return Vec3(kWidth * i, kWidth * j, kHeight - z[static_cast<std::size_t>(kCells - k)]);
         }});
    return nodes == 10 ? mesh : corners_only(mesh);
  }
  /// Forces of an even pressure of 1 MPa on the undeformed top.
  VecX unit_pressure() const {
    const bool quadratic = mesh.mid_nodes.rows() > 0;
    VecX force = VecX::Zero(x.size());
    const auto add = [&](Index node, double share) { force[3 * node + 2] -= share; };
    const TetMesh with_middles = quadratic ? mesh : fem::test::with_mid_nodes(mesh);
    const auto faces =
        faces_where(with_middles, [](const Vec3& X) { return X[2] > kHeight - 1e-9; });
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
      for (int a = 0; a < 3; ++a) add(faces(f, quadratic ? 3 + a : a), 0.5 * kWidth * kWidth / 3.0);
    return force;
  }
  /// Holds the platen's nodes along z as well.
  void hold_platen() {
    for (const Index i : top) {
      const auto place =
          std::lower_bound(constraints.particles.begin(), constraints.particles.end(), i);
      const bool known = place != constraints.particles.end() && *place == i;
      Mat3 free =
          known
              ? constraints.allowed[static_cast<std::size_t>(place - constraints.particles.begin())]
              : Mat3(Mat3::Identity());
      free(2, 2) = 0.0;
      constraints.add(i, free, Vec3::Zero());
    }
  }
  void place_platen(double strain) {
    for (const Index i : top) x[3 * i + 2] = kHeight * (1.0 - strain);
  }
  double settlement() const { return kHeight - x[3 * top[0] + 2]; }    // mm
  double stress() const { return force_on(top) / (kWidth * kWidth); }  // MPa, compression positive

  std::vector<Index> top;
};

double gel_time() { return kHeight * kHeight / (aggregate_modulus() * kMobility); }  // s

/// Sum over n >= 1 of term(n) until it no longer counts.
double series(const std::function<double(int)>& term) {
  double sum = 0.0;
  for (int n = 1; n < 4000; ++n) sum += term(n);
  return sum;
}

double creep(double T) {
  return 1.0 - 2.0 * series([&](int n) {
                 const double a = (n - 0.5) * kPi;
                 return std::exp(-a * a * T) / (a * a);
               });
}
double relaxation(double T) {
  return 1.0 + 2.0 * series([&](int n) { return std::exp(-n * n * kPi * kPi * T); });
}
/// Stress over modulus and final strain, for a strain that rises over T0 and stays.
double ramp(double T, double T0) {
  const double end = std::min(T, T0);
  return end / T0 + 2.0 / T0 * series([&](int n) {
                      const double w = n * n * kPi * kPi;
                      return (std::exp(-w * (T - end)) - std::exp(-w * T)) / w;
                    });
}

const char* elements(int nodes) { return nodes == 10 ? "ten-node" : "four-node"; }

void confined_creep(int nodes, Rows& rows) {
  Column column(nodes, {.reference = kMobility});
  const double load = kSmall * aggregate_modulus();
  const dynamics::ConstantForce press(load * column.unit_pressure());
  std::vector<double> times;
  for (const double T : {0.01, 0.03, 0.1, 0.25, 0.5, 1.0}) times.push_back(T * gel_time());
  follow(
      column, {&press}, times,
      {gel_time(), load * kWidth * kWidth, [](double) {},
       [&](double t) {
         const double T = t / gel_time();
         rows.push_back({join_text("confined creep, ", elements(nodes), ", T ", T, ": u H / F0 h"),
                         creep(T), column.settlement() / (kSmall * kHeight),
                         nodes == 10 ? 0.005 : 0.04, nodes == 10 ? "creep: u H / F0 h" : "", T});
       }});
}
void confined_relaxation(int nodes, Rows& rows) {
  Column column(nodes, {.reference = kMobility});
  column.hold_platen();
  std::vector<double> times;
  for (const double T : {0.01, 0.03, 0.1, 0.25, 0.5}) times.push_back(T * gel_time());
  follow(column, {}, times,
         {gel_time(), kSmall * aggregate_modulus() * kWidth * kWidth,
          [&](double) { column.place_platen(kSmall); },
          [&](double t) {
            const double T = t / gel_time();
            rows.push_back(
                {join_text("confined relaxation, ", elements(nodes), ", T ", T, ": stress / H e"),
                 relaxation(T), column.stress() / (kSmall * aggregate_modulus()), 0.005,
                 nodes == 10 ? "relaxation: stress / H e" : "", T});
          }});
}
void confined_ramp(Rows& rows) {
  constexpr double kRise = 0.2;  // of the gel time
  Column column(10, {.reference = kMobility});
  column.hold_platen();
  std::vector<double> times;
  for (const double T : {0.02, 0.1, kRise, 0.21, 0.25, 0.4}) times.push_back(T * gel_time());
  follow(column, {}, times,
         {gel_time(), kSmall * aggregate_modulus() * kWidth * kWidth,
          [&](double t) { column.place_platen(kSmall * std::min(1.0, t / (kRise * gel_time()))); },
          [&](double t) {
            const double T = t / gel_time();
            rows.push_back({join_text("confined ramp over T 0.2, T ", T, ": stress / H e"),
                            ramp(T, kRise), column.stress() / (kSmall * aggregate_modulus()), 0.005,
                            "ramp: stress / H e", T});
          },
          kRise * gel_time()});
}

/// Settlement of a column under a large load, by explicit finite volumes in one dimension: the
/// stretch l obeys dl/dt = d/dZ (k(l) / l dP/dZ), with l at the open top such that P(l) = -load.
std::vector<double> large_creep(const fem::Permeability& k, double load,
                                const std::vector<double>& times) {
  constexpr Index kCells = 250;
  const auto stress = [](double l) {
    return kSolid.mu * (l - 1.0 / l) + kSolid.lambda * std::log(l) / l;
  };
  double low = 0.1, high = 1.0;
  for (int i = 0; i < 60; ++i)
    (stress(0.5 * (low + high)) < -load ? low : high) = 0.5 * (low + high);
  const double width = kHeight / kCells;
  VecX l = VecX::Ones(kCells), flux = VecX::Zero(kCells + 1);
  std::vector<double> settlements;
  const double step = 0.1 * width * width / (kMobility * aggregate_modulus());
  double now = 0.0;
  for (const double end : times) {
    while (now < end) {
      const double h = std::min(step, end - now);
      for (Index i = 1; i < kCells; ++i) {
        const double mean = 0.5 * (l[i] + l[i - 1]);
        flux[i] = k.at(mean) / mean * (stress(l[i]) - stress(l[i - 1])) / width;
      }
      const double mean = 0.5 * (low + l[kCells - 1]);
      flux[kCells] = k.at(mean) / mean * (-load - stress(l[kCells - 1])) / (0.5 * width);
      for (Index i = 0; i < kCells; ++i) l[i] += h / width * (flux[i + 1] - flux[i]);
      now += h;
    }
    settlements.push_back(kHeight - l.sum() * width);
  }
  return settlements;
}
void confined_large_creep(Rows& rows) {
  const fem::Permeability k{
      .reference = kMobility, .solid_share = 0.2, .exponent = 2.0, .stiffening = 2.0};
  const double load = 0.6 * aggregate_modulus();
  Column column(10, k);
  const dynamics::ConstantForce press(load * column.unit_pressure());
  std::vector<double> times;
  for (const double T : {0.03, 0.1, 0.3, 1.0, 3.0}) times.push_back(T * gel_time());
  const std::vector<double> reference = large_creep(k, load, times);
  std::size_t n = 0;
  follow(column, {&press}, times,
         {gel_time(), load * kWidth * kWidth, [](double) {},
          [&](double t) {
            const double T = t / gel_time();
            rows.push_back({join_text("large creep, k(J), load 0.6 H, T ", T, ": u / h"),
                            reference[n++] / kHeight, column.settlement() / kHeight, 0.01,
                            "large creep: u / h", T});
          }});
}

/// Roots of J1(x) = (1 - nu) / (1 - 2 nu) x J0(x), ascending.
std::vector<double> unconfined_roots(double nu, int n) {
  const auto f = [&](double x) {
    return std::cyl_bessel_j(1.0, x) -
           (1.0 - nu) / (1.0 - 2.0 * nu) * x * std::cyl_bessel_j(0.0, x);
  };
  std::vector<double> roots;
  for (double x = 0.1; static_cast<int>(roots.size()) < n; x += 0.05) {
    double low = x, high = x + 0.05;
    if (f(low) * f(high) > 0.0) continue;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (f(low) * f(middle) <= 0.0 ? high : low) = middle;
    }
    roots.push_back(low);
  }
  return roots;
}
/// A disc between smooth sealed plates, open at its side, strained at once: Armstrong, Lai and Mow
/// 1984.
void unconfined_relaxation(Rows& rows) {
  constexpr double kRadius = 1.0, kAngle = radians(4.0), kNu = 0.15, kE = 0.7;
  std::vector<double> r = graded(kRadius, 24, 1.15);
  std::reverse(r.begin(), r.end());
  for (double& value : r) value = kRadius - value;
  const Sector sector = make_sector(r, {0.0, 0.25}, kAngle);
  Body body(sector.mesh, {.reference = kMobility});
  for (Index i = 0; i < body.mesh.n_vertices(); ++i) {
    const Vec3 X = body.mesh.points.row(i);
    const double radius = X.head<2>().norm(), phi = std::atan2(X[1], X[0]);
    Mat3 free = Mat3::Identity();
    if (radius < 1e-9) {
      free = Vec3(0, 0, 1).asDiagonal();
    } else if (std::abs(std::abs(phi) - 0.5 * kAngle) < 1e-6) {
      const Vec3 across(-std::sin(phi), std::cos(phi), 0.0);
      free -= across * across.transpose();
    }
    if (X[2] < 1e-9 || X[2] > 0.25 - 1e-9) free(2, 2) = 0.0;
    if (free != Mat3::Identity()) body.constraints.add(i, free, Vec3::Zero());
  }
  const auto top = body.nodes_where([](const Vec3& X) { return X[2] > 0.25 - 1e-9; });
  const double rim = kRadius * std::cos(0.5 * kAngle);
  body.fluid.add_drained(
      body.nodes_where([&](const Vec3& X) { return X.head<2>().norm() > rim - 1e-6; }),
      body.constraints);
  const double slowest = kRadius * kRadius / (aggregate_modulus() * kMobility);
  const auto roots = unconfined_roots(kNu, 400);
  const auto known = [&](double T) {
    double sum = 1.0;
    for (const double a : roots)
      sum += (1.0 - kNu) * (1.0 - 2.0 * kNu) / (1.0 + kNu) * std::exp(-a * a * T) /
             (std::pow((1.0 - kNu) * a, 2) - (1.0 - 2.0 * kNu));
    return sum;
  };
  std::vector<double> times;
  for (const double T : {0.003, 0.01, 0.03, 0.1, 0.3}) times.push_back(T * slowest);
  follow(body, {}, times,
         {slowest, kSmall * kE,
          [&](double) {
            for (const Index i : top) body.x[3 * i + 2] = 0.25 * (1.0 - kSmall);
          },
          [&](double t) {
            const double T = t / slowest;
            const double stress =
                body.force_on(top) * sector.multiplicity() / (kPi * kRadius * kRadius);
            rows.push_back({join_text("unconfined relaxation, T ", T, ": stress / E e"), known(T),
                            stress / (kE * kSmall), 0.01, "unconfined: stress / E e", T});
          }});
}

}  // namespace

Rows biphasic() {
  Rows rows;
  for (const int nodes : {10, 4}) {
    confined_creep(nodes, rows);
    confined_relaxation(nodes, rows);
  }
  confined_ramp(rows);
  confined_large_creep(rows);
  unconfined_relaxation(rows);
  return rows;
}

}  // namespace coxa::verify
