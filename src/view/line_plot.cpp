#include <coxa/view/line_plot.h>

#include <coxa/core/error.h>
#include <coxa/view/colour_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace coxa::view {
namespace {

struct Style {
  const char* colour;
  const char* dashes;
};
// mid-tone colours that show on white and on black
constexpr std::array<Style, 6> kStyles{{{"#2a78b5", ""},
                                        {"#d55e00", "7 3"},
                                        {"#1a9e77", "2 3"},
                                        {"#a05fa8", "9 3 2 3"},
                                        {"#9a7d0a", "4 2"},
                                        {"#c2406b", "1 2"}}};
constexpr double kLeft = 64.0, kRight = 14.0, kTop = 30.0, kBottom = 46.0, kLegendRow = 18.0;

struct Range {
  double low = kInfinity, high = -kInfinity;
  void add(const VecX& values) {
    for (double v : values)
      if (std::isfinite(v)) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
  }
  void widen(double share) {
    const double margin = high > low ? share * (high - low) : std::max(1e-9, 0.5 * std::abs(high));
    low -= margin;
    high += margin;
  }
};

class Plotter {
 public:
  explicit Plotter(const LinePlot& plot) : plot_(plot) {
    for (const Series& s : plot.series) {
      require(s.x.size() == s.y.size(), "line_plot_svg: series '", s.label, "' has ", s.x.size(),
              " x and ", s.y.size(), " y");
      x_.add(s.x);
      y_.add(s.y);
    }
    for (const Band& b : plot.bands) {
      require(b.x.size() == b.low.size() && b.x.size() == b.high.size(), "line_plot_svg: band '",
              b.label, "' has ", b.x.size(), " x, ", b.low.size(), " low and ", b.high.size(),
              " high");
      y_.add(b.low);
      y_.add(b.high);
    }
    require(x_.low <= x_.high && y_.low <= y_.high, "line_plot_svg: no value is finite");
    x_.widen(0.0);
    y_.widen(0.06);
    bottom_ = plot.height - kBottom - kLegendRow * legend_rows();
    require(bottom_ > kTop + 40.0, "line_plot_svg: ", plot.height,
            " pixels are too low for the legend");
  }

  std::string run() {
    svg_ << "<svg role=\"img\" aria-label=\"" << escaped(plot_.title) << "\" viewBox=\"0 0 "
         << plot_.width << ' ' << plot_.height << "\" width=\"" << plot_.width << "\" height=\""
         << plot_.height
         << "\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" font-size=\"12\" "
            "fill=\"currentColor\">\n"
         << "<title>" << escaped(plot_.title) << "</title>\n";
    text(0.5 * (kLeft + plot_.width - kRight), 18.0, plot_.title, "middle");
    for (std::size_t i = 0; i < plot_.bands.size(); ++i) band(plot_.bands[i]);
    axes();
    for (std::size_t i = 0; i < plot_.series.size(); ++i)
      curve(plot_.series[i], kStyles[i % kStyles.size()]);
    legend();
    svg_ << "</svg>\n";
    return svg_.str();
  }

 private:
  std::size_t legend_entries() const { return plot_.series.size() + plot_.bands.size(); }
  double legend_rows() const { return std::ceil(static_cast<double>(legend_entries()) / 2.0); }
  double px(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (plot_.width - kRight - kLeft);
  }
  double py(double y) const {
    return bottom_ - (y - y_.low) / (y_.high - y_.low) * (bottom_ - kTop);
  }
  static std::string number(double value) { return tick_label(value, 0.1); }

  void text(double x, double y, const std::string& what, const char* anchor) {
    svg_ << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" text-anchor=\"" << anchor
         << "\">" << escaped(what) << "</text>\n";
  }
  void line(double x0, double y0, double x1, double y1, double opacity) {
    svg_ << "<line x1=\"" << number(x0) << "\" y1=\"" << number(y0) << "\" x2=\"" << number(x1)
         << "\" y2=\"" << number(y1) << "\" stroke=\"currentColor\" stroke-opacity=\"" << opacity
         << "\"/>\n";
  }

  void axes() {
    const double right = plot_.width - kRight;
    const auto xs = nice_ticks(x_.low, x_.high, 7), ys = nice_ticks(y_.low, y_.high, 5);
    const auto step = [](const std::vector<double>& ticks) {
      return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
    };
    for (double x : xs) {
      line(px(x), kTop, px(x), bottom_, 0.12);
      text(px(x), bottom_ + 16.0, tick_label(x, step(xs)), "middle");
    }
    for (double y : ys) {
      line(kLeft, py(y), right, py(y), 0.12);
      text(kLeft - 6.0, py(y) + 4.0, tick_label(y, step(ys)), "end");
    }
    line(kLeft, bottom_, right, bottom_, 0.8);
    line(kLeft, kTop, kLeft, bottom_, 0.8);
    text(0.5 * (kLeft + right), bottom_ + 34.0, plot_.x_label, "middle");
    svg_ << "<text transform=\"translate(14 " << number(0.5 * (kTop + bottom_))
         << ") rotate(-90)\" text-anchor=\"middle\">" << escaped(plot_.y_label) << "</text>\n";
  }

  void curve(const Series& series, const Style& style) {
    svg_ << "<path fill=\"none\" stroke=\"" << style.colour
         << "\" stroke-width=\"2\" stroke-dasharray=\"" << style.dashes << "\" d=\"";
    bool pen_down = false;
    for (Eigen::Index i = 0; i < series.x.size(); ++i) {
      const bool shown = std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
      if (shown)
        svg_ << (pen_down ? 'L' : 'M') << number(px(series.x[i])) << ' ' << number(py(series.y[i]));
      pen_down = shown;
    }
    svg_ << "\"/>\n";
  }

  void band(const Band& band) {
    svg_ << "<polygon fill=\"currentColor\" fill-opacity=\"0.14\" points=\"";
    const auto inside = [&](double x) { return std::clamp(px(x), kLeft, plot_.width - kRight); };
    for (Eigen::Index i = 0; i < band.x.size(); ++i)
      svg_ << number(inside(band.x[i])) << ',' << number(py(band.low[i])) << ' ';
    for (Eigen::Index i = band.x.size(); i-- > 0;)
      svg_ << number(inside(band.x[i])) << ',' << number(py(band.high[i])) << ' ';
    svg_ << "\"/>\n";
  }

  void legend() {
    const double half = 0.5 * (plot_.width - kLeft);
    for (std::size_t i = 0; i < legend_entries(); ++i) {
      const double x = kLeft + half * static_cast<double>(i % 2),
                   y = bottom_ + 52.0 + kLegendRow * static_cast<double>(i / 2);
      if (i < plot_.series.size()) {
        const Style& style = kStyles[i % kStyles.size()];
        svg_ << "<line x1=\"" << number(x) << "\" y1=\"" << number(y - 4) << "\" x2=\""
             << number(x + 26) << "\" y2=\"" << number(y - 4) << "\" stroke=\"" << style.colour
             << "\" stroke-width=\"2\" stroke-dasharray=\"" << style.dashes << "\"/>\n";
        text(x + 32, y, plot_.series[i].label, "start");
      } else {
        svg_ << "<rect x=\"" << number(x) << "\" y=\"" << number(y - 10)
             << "\" width=\"26\" height=\"12\" fill-opacity=\"0.14\"/>\n";
        text(x + 32, y, plot_.bands[i - plot_.series.size()].label, "start");
      }
    }
  }

  const LinePlot& plot_;
  Range x_, y_;
  double bottom_ = 0.0;
  std::ostringstream svg_;
};

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for (char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string line_plot_svg(const LinePlot& plot) {
  require(plot.width >= 200 && plot.height >= 150, "line_plot_svg: at least 200 x 150 pixels, got ",
          plot.width, " x ", plot.height);
  return Plotter(plot).run();
}

}  // namespace coxa::view
