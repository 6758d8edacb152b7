#include <coxa/image/phantom.h>

#include <cmath>

namespace coxa {
namespace {

/// Relaxation at 1.5 T. Times in ms; densities relative to pure water.
struct Protons {
  double density;
  double t1, t2;
};
struct TissueProtons {
  Protons water, fat;
};

constexpr Protons kFat{0.90, 288.0, 165.0};
constexpr Protons kNone{0.0, 1.0, 1.0};

TissueProtons protons_of(Tissue tissue) {
  switch (tissue) {
    case Tissue::air:
      return {kNone, kNone};
    case Tissue::fat:
      return {{0.08, 1130.0, 35.0}, kFat};
    case Tissue::muscle:
      return {{0.76, 1130.0, 35.0}, {0.03, 288.0, 165.0}};
    case Tissue::marrow:
      return {{0.22, 1000.0, 40.0}, {0.68, 288.0, 165.0}};
    case Tissue::cortical_bone:
      return {{0.18, 250.0, 0.5}, {0.02, 288.0, 165.0}};
    case Tissue::cartilage:
      return {{0.72, 1060.0, 42.0}, kNone};
    case Tissue::fluid:
      return {{0.98, 2850.0, 1210.0}, kNone};
    case Tissue::fibrous:
      return {{0.60, 900.0, 8.0}, kNone};
    case Tissue::skin:
      return {{0.65, 900.0, 25.0}, {0.05, 288.0, 165.0}};
  }
  return {kNone, kNone};
}

/// Spin echo: TR and TE in ms.
double spin_echo(const Protons& p, double tr, double te) {
  return p.density * (1.0 - std::exp(-tr / p.t1)) * std::exp(-te / p.t2);
}

/// Sum of the two echoes of a double-echo steady state.
///
/// Source: steady state of Gyngell 1988 / Haenicke and Vogel 2003, FID (FISP) and echo (PSIF)
/// signals.
double double_echo(const Protons& p, double tr, double te, double flip) {
  if (p.density <= 0.0) return 0.0;
  const double e1 = std::exp(-tr / p.t1), e2 = std::exp(-tr / p.t2), c = std::cos(flip);
  const double a = 1.0 - e1 * c - e2 * e2 * (e1 - c);
  const double b = e2 * (1.0 - e1) * (1.0 + c);
  const double r = (1.0 - e2 * e2) / std::sqrt(a * a - b * b);
  const double half = std::tan(0.5 * flip);
  const double fid = half * (1.0 - (e1 - c) * r) * std::exp(-te / p.t2);
  const double echo = half * (1.0 - (1.0 - e1 * c) * r) * std::exp(te / p.t2);
  return p.density * (fid + echo);
}

/// Share of the fat signal that a water excitation pulse leaves.
constexpr double kFatLeft = 0.08;

double signal_of(const Protons& p, Contrast contrast) {
  switch (contrast) {
    case Contrast::t1:
      return spin_echo(p, 500.0, 14.0);
    case Contrast::t2:
      return spin_echo(p, 4000.0, 90.0);
    case Contrast::pd:
      return spin_echo(p, 3000.0, 20.0);
    case Contrast::dess:
      return double_echo(p, 16.0, 5.0, radians(25.0));
  }
  return 0.0;
}

}  // namespace

Signal tissue_signal(Tissue tissue, Contrast contrast) {
  const TissueProtons protons = protons_of(tissue);
  const double left = contrast == Contrast::dess ? kFatLeft : 1.0;
  return {signal_of(protons.water, contrast), left * signal_of(protons.fat, contrast)};
}

}  // namespace coxa
