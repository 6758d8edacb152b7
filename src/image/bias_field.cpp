#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/image/intensity.h>

#include <Eigen/Cholesky>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace coxa {
namespace {

constexpr Index kBins = 200;     ///< of the log histogram, as in N3
constexpr Index kPadded = 512;   ///< room for the tails of the convolutions
constexpr double kNoise = 0.01;  ///< Wiener filter constant of N3

using Spectrum = Eigen::VectorXcd;

void check(const BiasFieldOptions& options) {
  require(options.working_voxel > 0.0, "working_voxel must be positive, got ",
          options.working_voxel, " mm");
  require(1 <= options.degree && options.degree <= 6, "degree must be in [1, 6], got ",
          options.degree);
  require(options.iterations >= 1, "iterations must be at least 1, got ", options.iterations);
  require(options.width > 0.0, "width must be positive, got ", options.width);
  require(options.tolerance > 0.0, "tolerance must be positive, got ", options.tolerance);
}

/// Monomials x^a y^b z^c, a + b + c <= degree, of coordinates scaled to [-1, 1] over the volume.
class Polynomial {
 public:
  Polynomial(const Volume& volume, int degree) : degree_(degree) {
    for (int a = 0; a < 3; ++a) {
      half_[a] = std::max(0.5 * (volume.size[static_cast<std::size_t>(a)] - 1), 0.5);
    }
  }
  Index n_terms() const { return (degree_ + 1) * (degree_ + 2) * (degree_ + 3) / 6; }
  /// @param index voxel index in the volume
  VecX terms(const Vec3& index) const {
    const Vec3 q = index.cwiseQuotient(half_) - Vec3::Ones();
    VecX result(n_terms());
    Index n = 0;
    double x = 1.0;
    for (int a = 0; a <= degree_; ++a, x *= q[0]) {
      double y = x;
      for (int b = 0; a + b <= degree_; ++b, y *= q[1]) {
        double z = y;
        for (int c = 0; a + b + c <= degree_; ++c, z *= q[2]) result[n++] = z;
      }
    }
    return result;
  }

 private:
  int degree_;
  Vec3 half_;
};

/// Log values of the body on a coarse grid, with the polynomial's terms there.
struct Samples {
  VecX log_values;
  MatX terms;  ///< n×m
};

Samples gather(const Volume& volume, const Polynomial& polynomial, double working_voxel) {
  const double threshold = foreground_threshold(volume);
  std::array<Index, 3> step;
  for (std::size_t a = 0; a < 3; ++a) {
    step[a] = std::max<Index>(
        1, static_cast<Index>(std::lround(working_voxel / volume.spacing[static_cast<Index>(a)])));
  }
  std::vector<double> values;
  std::vector<VecX> rows;
  for (Index k = step[2] / 2; k < volume.size[2]; k += step[2]) {
    for (Index j = step[1] / 2; j < volume.size[1]; j += step[1]) {
      for (Index i = step[0] / 2; i < volume.size[0]; i += step[0]) {
        const auto at = static_cast<std::size_t>(volume.offset(i, j, k));
        if (volume.values[at] <= threshold) continue;
        values.push_back(std::log(static_cast<double>(volume.values[at])));
        rows.push_back(polynomial.terms(Vec3(i, j, k)));
      }
    }
  }
  require(static_cast<Index>(rows.size()) > 2 * polynomial.n_terms(),
          "the image has too little foreground (", rows.size(), " samples of ", working_voxel,
          " mm) for a bias field of ", polynomial.n_terms(), " terms");
  Samples samples;
  samples.log_values = Eigen::Map<const VecX>(values.data(), static_cast<Index>(values.size()));
  samples.terms.resize(static_cast<Index>(rows.size()), polynomial.n_terms());
  for (std::size_t r = 0; r < rows.size(); ++r) samples.terms.row(static_cast<Index>(r)) = rows[r];
  return samples;
}

Spectrum transformed(const VecX& values) {
  Eigen::FFT<double> fft;
  Spectrum result;
  fft.fwd(result, values);
  return result;
}

VecX back(const Spectrum& spectrum) {
  Eigen::FFT<double> fft;
  VecX result;
  fft.inv(result, spectrum);
  return result;
}

/// What each value would be without the blur that a bias field brings to the histogram.
VecX sharpened(const VecX& u, double width) {
  const double low = u.minCoeff(), bin = std::max((u.maxCoeff() - low) / (kBins - 1), 1e-12);
  const Index margin = (kPadded - kBins) / 2;
  VecX histogram = VecX::Zero(kPadded), centres(kPadded);
  for (Index b = 0; b < kPadded; ++b) centres[b] = low + bin * (b - margin);
  for (Index i = 0; i < u.size(); ++i) {
    const double x = (u[i] - low) / bin;
    const auto b = std::min(static_cast<Index>(x), kBins - 2);
    histogram[margin + b] += 1.0 - (x - b);
    histogram[margin + b + 1] += x - b;
  }
  // blur of the field: a Gaussian around bin 0, wrapped
  const double sigma = width / std::sqrt(8.0 * std::log(2.0)) / bin;
  VecX kernel(kPadded);
  for (Index b = 0; b < kPadded; ++b) {
    const double d = std::min(b, kPadded - b);
    kernel[b] = std::exp(-0.5 * d * d / (sigma * sigma));
  }
  kernel /= kernel.sum();
  const Spectrum blur = transformed(kernel);
  const Spectrum wiener = blur.conjugate().cwiseQuotient(
      (blur.cwiseAbs2().array() + kNoise).matrix().cast<std::complex<double>>());
  const VecX sharp = back(transformed(histogram).cwiseProduct(wiener)).cwiseMax(0.0);
  const VecX weight = back(transformed(sharp).cwiseProduct(blur));
  const VecX moment = back(transformed(sharp.cwiseProduct(centres)).cwiseProduct(blur));
  VecX expected(kPadded);
  for (Index b = 0; b < kPadded; ++b) {
    expected[b] = weight[b] > 1e-9 * histogram.maxCoeff() ? moment[b] / weight[b] : centres[b];
  }
  VecX result(u.size());
  for (Index i = 0; i < u.size(); ++i) {
    const double x = (u[i] - low) / bin;
    const auto b = std::min(static_cast<Index>(x), kBins - 2);
    result[i] = expected[margin + b] + (x - b) * (expected[margin + b + 1] - expected[margin + b]);
  }
  return result;
}

/// Log of the field; its mean over the samples is 0, and it keeps to its range there.
struct LogField {
  VecX coefficients;
  double low = 0.0, high = 0.0;
};

LogField fit_log_field(const Samples& samples, const BiasFieldOptions& options,
                       const Monitor& monitor) {
  const MatX& A = samples.terms;
  const double ridge =
      1e-6 * static_cast<double>(A.rows());  // where the body does not fill the volume
  const Eigen::LLT<MatX> normal(A.transpose() * A + ridge * MatX::Identity(A.cols(), A.cols()));
  VecX coefficients = VecX::Zero(A.cols());
  for (int n = 0; n < options.iterations; ++n) {
    monitor.check_cancelled();
    const VecX field = A * coefficients;
    const VecX u = samples.log_values - field;
    VecX residual = field + u - sharpened(u, options.width);
    residual.array() -= residual.mean();
    const VecX next = normal.solve(A.transpose() * residual);
    const VecX change = A * (next - coefficients);
    coefficients = next;
    if (std::sqrt((change.array() - change.mean()).square().mean()) < options.tolerance) break;
  }
  coefficients[0] -= (A * coefficients).mean();
  const VecX field = A * coefficients;
  return {coefficients, field.minCoeff(), field.maxCoeff()};
}

}  // namespace

Volume bias_field(const Volume& volume, const BiasFieldOptions& options, const Monitor& monitor) {
  check(options);
  const Polynomial polynomial(volume, options.degree);
  const LogField log_field =
      fit_log_field(gather(volume, polynomial, options.working_voxel), options, monitor);
  Volume field = volume;
  const Index ny = volume.size[1];
  parallel_for(static_cast<std::int64_t>(ny) * volume.size[2], [&](Index row) {
    monitor.check_cancelled();
    const Index j = row % ny, k = row / ny;
    for (Index i = 0; i < volume.size[0]; ++i) {
      field.values[static_cast<std::size_t>(volume.offset(i, j, k))] = static_cast<float>(
          std::exp(std::clamp(log_field.coefficients.dot(polynomial.terms(Vec3(i, j, k))),
                              log_field.low, log_field.high)));
    }
  });
  return field;
}

Volume bias_corrected(const Volume& volume, const BiasFieldOptions& options,
                      const Monitor& monitor) {
  const Volume field = bias_field(volume, options, monitor);
  Volume result = volume;
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] /= field.values[i];
  return result;
}

}  // namespace coxa
