#include <coxa/view/report.h>

#include <coxa/core/error.h>
#include <coxa/view/png.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace coxa::view {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t i = text.find(what); i != std::string::npos; i = text.find(what, i + 1)) ++n;
  return n;
}
LinePlot simple_plot() {
  return {.title = "Peak <pressure>",
          .x_label = "time [s]",
          .y_label = "p [MPa]",
          .series = {{"a & b", VecX::LinSpaced(5, 0, 4), VecX::LinSpaced(5, 0, 8)}}};
}
ReportWriter simple_report() {
  ReportWriter report("Hip of \"A<B\"", "right side");
  report.heading("Pressure");
  report.paragraph("1 < 2 & 3");
  report.notice(Notice::warning, "low confidence");
  report.list({"one", "two"});
  report.table({"frame", "peak [MPa]"}, {{"0", "1.5"}, {"1", "2.5"}}, "Peaks");
  report.picture(Image(4, 3, kInk), "a dark square", "Figure 1");
  report.plot(simple_plot());
  report.begin_details("Methods");
  report.paragraph("more");
  report.end_details();
  return report;
}

TEST(Report, EscapesAllTextAndLoadsNothing) {
  const std::string html = simple_report().html();
  EXPECT_NE(html.find("<title>Hip of &quot;A&lt;B&quot;</title>"), std::string::npos);
  EXPECT_NE(html.find("<p>1 &lt; 2 &amp; 3</p>"), std::string::npos);
  EXPECT_EQ(count(html, "<script"), 0u);
  EXPECT_EQ(count(html, "http://"), count(html, "http://www.w3.org/2000/svg"));
  EXPECT_EQ(count(html, "https://"), 0u);
  EXPECT_EQ(count(html, "url("), 0u);
}
TEST(Report, HoldsThePictureWithItsAlternative) {
  const std::string html = simple_report().html();
  EXPECT_NE(
      html.find("<img alt=\"a dark square\" width=\"4\" height=\"3\" src=\"data:image/png;base64," +
                base64(encode_png(Image(4, 3, kInk))) + "\">"),
      std::string::npos);
  EXPECT_NE(html.find("<figcaption>Figure 1</figcaption>"), std::string::npos);
  ReportWriter report("x", "");
  EXPECT_THROW(report.picture(Image(4, 3), ""), Error);
}
TEST(Report, TagsAreBalancedAndTablesComplete) {
  const std::string html = simple_report().html();
  for (const char* tag :
       {"html",  "head",  "body", "main", "h1",     "h2",  "p",       "ul",      "li",    "table",
        "thead", "tbody", "tr",   "td",   "figure", "svg", "details", "summary", "title", "style"})
    EXPECT_EQ(count(html, std::string("<") + tag + ">") + count(html, std::string("<") + tag + " "),
              count(html, std::string("</") + tag + ">"))
        << tag;
  EXPECT_EQ(count(html, "<th scope=\"col\">"), 2u);
  EXPECT_NE(html.find("<th scope=\"row\">1</th><td>2.5</td>"), std::string::npos);
  EXPECT_NE(html.find("prefers-color-scheme: dark"), std::string::npos);
  EXPECT_NE(html.find("<html lang=\"en\">"), std::string::npos);
}
TEST(Report, RejectsBrokenStructure) {
  ReportWriter report("x", "");
  EXPECT_THROW(report.table({"a", "b"}, {{"1"}}), Error);
  EXPECT_THROW(report.heading("x", 1), Error);
  EXPECT_THROW(report.end_details(), Error);
  report.begin_details("open");
  EXPECT_THROW(report.html(), Error);
}
TEST(Report, WritesItsPageWhole) {
  const auto path = std::filesystem::temp_directory_path() / "coxa_view_report_test.html";
  simple_report().write(path);
  std::ifstream file(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), simple_report().html());
  std::filesystem::remove(path);
  EXPECT_THROW(simple_report().write("/nowhere/report.html"), Error);
}

TEST(LinePlot, DrawsTheCurveThroughItsPoints) {
  const std::string svg = line_plot_svg(simple_plot());
  // x from 64 to 546 over 4 s; y over -0.48 to 8.48 between 256 and 30
  EXPECT_NE(svg.find("d=\"M64.0 243.9L184.5 193.4L305.0 143.0L425.5 92.6L546.0 42.1\""),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("aria-label=\"Peak &lt;pressure&gt;\""), std::string::npos);
  EXPECT_NE(svg.find("a &amp; b"), std::string::npos);
}
TEST(LinePlot, BreaksTheLineWhereAValueIsMissing) {
  LinePlot plot = simple_plot();
  plot.series[0].y[2] = kNaN;
  const std::string svg = line_plot_svg(plot);
  EXPECT_NE(svg.find("L184.5 193.4M425.5 92.6L"), std::string::npos) << svg;
}
TEST(LinePlot, ShowsBandsAndCountsThemInTheRange) {
  LinePlot plot = simple_plot();
  plot.bands = {
      {"normal", VecX::LinSpaced(2, 0, 4), VecX::Constant(2, -4.0), VecX::Constant(2, 20.0)}};
  const std::string svg = line_plot_svg(plot);
  EXPECT_EQ(count(svg, "<polygon"), 1u);
  EXPECT_NE(svg.find(">normal</text>"), std::string::npos);
  EXPECT_NE(svg.find(">20</text>"), std::string::npos);
}
TEST(LinePlot, RejectsUnequalSeriesAndNothingToShow) {
  LinePlot plot = simple_plot();
  plot.series[0].y.conservativeResize(3);
  EXPECT_THROW(line_plot_svg(plot), Error);
  plot.series[0] = {"empty", VecX::Zero(2), VecX::Constant(2, kNaN)};
  EXPECT_THROW(line_plot_svg(plot), Error);
  plot = simple_plot();
  plot.width = 10;
  EXPECT_THROW(line_plot_svg(plot), Error);
  plot = simple_plot();
  plot.bands = {{"b", VecX::Zero(2), VecX::Zero(1), VecX::Zero(2)}};
  EXPECT_THROW(line_plot_svg(plot), Error);
}

}  // namespace coxa::view
