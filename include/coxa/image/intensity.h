#pragma once

#include <coxa/core/monitor.h>
#include <coxa/image/volume.h>

#include <vector>

namespace coxa {

/// Values below which the given shares of the voxels lie, interpolated between voxels.
///
/// @param shares each in [0, 1]
std::vector<double> intensity_percentiles(const Volume& volume, const std::vector<double>& shares);

/// Threshold between air and body: the value that parts the histogram into the two classes with the
/// largest variance between them, on the logarithm of positive values.
///
/// Source: Otsu 1979. @throws Error bad_input if fewer than two different positive values are there
double foreground_threshold(const Volume& volume);

/// Values mapped linearly so that the shares `low` and `high` of the foreground become 0 and 1.
/// @throws Error bad_input if the two percentiles coincide or the shares are not 0 <= low < high <=
/// 1
Volume normalised(const Volume& volume, double low = 0.05, double high = 0.95);

struct BiasFieldOptions {
  double working_voxel = 4.0;  ///< mm, > 0: the field is estimated on a grid this coarse
  int degree = 4;              ///< of the polynomial, 1 to 6
  int iterations = 60;         ///< at most, >= 1
  double width = 0.15;         ///< full width at half maximum of the assumed field's log histogram
  double tolerance = 1e-4;     ///< stop when the log field changes by less (standard deviation)
};

/// Coil shading: a smooth positive field whose geometric mean over the body is 1; outside the body
/// it keeps to its range inside.
///
/// The log histogram is sharpened, what a voxel lacks to its sharpened value is the field, and a
/// polynomial keeps it smooth; repeated.
/// Source: N3, Sled et al. 1998 (IEEE TMI 17:87), iterated on the remaining field as in N4,
/// Tustison et al. 2010; polynomial in place of B-splines.
/// @throws Error bad_input if an option is out of range or the image has no foreground; cancelled
Volume bias_field(const Volume& volume, const BiasFieldOptions& options = {},
                  const Monitor& monitor = {});

/// The image divided by its bias field.
Volume bias_corrected(const Volume& volume, const BiasFieldOptions& options = {},
                      const Monitor& monitor = {});

}  // namespace coxa
