#pragma once

#include <coxa/core/types.h>
#include <coxa/view/image.h>

#include <string>
#include <string_view>
#include <vector>

namespace coxa::view {

/// One curve. Lines differ in dashes as well as in colour.
struct Series {
  std::string label;
  VecX x;
  VecX y;  ///< as many as x; NaN breaks the line
};

/// A shaded range, for example normal values.
struct Band {
  std::string label;
  VecX x;
  VecX low;   ///< as many as x
  VecX high;  ///< as many as x
};

struct LinePlot {
  std::string title;    ///< also read out by screen readers
  std::string x_label;  ///< with unit
  std::string y_label;  ///< with unit
  std::vector<Series> series;
  std::vector<Band> bands = {};
  int width = 560;   ///< pixels, >= 200
  int height = 320;  ///< pixels, >= 150
};

/// The plot as an SVG element: no external resources; axes and text take the page's text colour.
/// @throws Error bad_input if x and y differ in number, or no value is finite
std::string line_plot_svg(const LinePlot& plot);

/// Text with &, <, >, " and ' made safe for HTML and SVG.
std::string escaped(std::string_view text);

}  // namespace coxa::view
