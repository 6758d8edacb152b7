#pragma once

#include <coxa/view/image.h>

#include <string>
#include <string_view>

namespace coxa::view {

/// Perceptually uniform maps that survive colour blindness and grey printing.
enum class ColourMap {
  viridis,  ///< dark blue to yellow
  cividis,  ///< blue to yellow, nearly the same for every kind of colour vision
  grey      ///< black to white, linear
};

/// Colour at `share` in [0, 1], clamped; NaN gives light grey.
/// Source: van der Walt and Smith 2015; Nuñez et al. 2018 (tables of 33 colours, linear in
/// between).
Colour map_colour(ColourMap map, double share);

/// A range of values and what it is called.
struct ColourScale {
  ColourMap map = ColourMap::viridis;
  double low = 0.0;
  double high = 1.0;       ///< > low
  std::string label = {};  ///< with unit, for example "pressure [MPa]"
};
Colour scale_colour(const ColourScale& scale, double value);

/// Round numbers that divide [low, high] into about `n` steps, ascending, inside the range.
std::vector<double> nice_ticks(double low, double high, int n = 5);
/// The number as a label: enough digits for steps of `step`, no more.
std::string tick_label(double value, double step);

/// Upright colour bar with ticks, numbers and the label.
Image draw_colour_bar(const ColourScale& scale, int height, double text_size = 14.0);

/// Fixed colour of a structure by its name in the house's vocabulary; other names get one by their
/// letters.
Colour structure_colour(std::string_view name);
/// The name for people: "femoral_cartilage" becomes "femoral cartilage".
std::string readable(std::string_view name);

}  // namespace coxa::view
