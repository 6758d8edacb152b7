#include "random_field.h"

#include <cmath>

namespace coxa::shape {
namespace {

// random Fourier features (Rahimi and Recht 2007); enough that the field looks Gaussian
constexpr int kWaves = 200;

}  // namespace

RandomField::RandomField(double rms, double length, Rng& rng) {
  // a wave of amplitude a has mean square |a|² / 2, and |normal3|² is 3 on average
  const double amplitude = rms * std::sqrt(2.0 / (3.0 * kWaves));
  for (int i = 0; i < kWaves; ++i) {
    const Vec3 frequency = rng.normal3() / length;
    const Vec3 direction = rng.normal3();
    waves_.push_back({frequency, amplitude * direction, rng.uniform(0.0, 2.0 * kPi)});
  }
}

Vec3 RandomField::operator()(const Vec3& p) const {
  Vec3 sum = Vec3::Zero();
  for (const Wave& wave : waves_)
    sum += wave.amplitude * std::cos(wave.frequency.dot(p) + wave.phase);
  return sum;
}

}  // namespace coxa::shape
