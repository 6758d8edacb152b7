#include <coxa/view/report.h>

#include "write_whole.h"

#include <coxa/core/error.h>
#include <coxa/view/png.h>

#include <algorithm>

namespace coxa::view {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --paper: #fff; --ink: #222; --faint: #5a5a5a; --line: #ccc; --shade: #f3f4f6; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181b; --ink: #e6e6e6; --faint: #a8a8a8; --line: #44484d; --shade: #212429; }
}
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 1100px; margin: 0 auto; padding: 1.5rem; }
h1 { margin: 0 0 .2rem; } h2 { margin-top: 2.2rem; border-bottom: 1px solid var(--line); }
.subtitle, figcaption, caption { color: var(--faint); } caption { text-align: left; }
.scroll { overflow-x: auto; } .scroll td:last-child { min-width: 18rem; }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid var(--line); padding: .3rem .7rem; text-align: left; } th { background: var(--shade); }
figure { margin: 1rem 0; overflow-x: auto; } img { max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
svg { max-width: 100%; height: auto; }
.notice { border-left: 5px solid; padding: .5rem 1rem; margin: 1rem 0; background: var(--shade); }
.information { border-color: #2a78b5; } .warning { border-color: #d08a00; } .error { border-color: #c8102e; }
details { margin: 1rem 0; } summary { cursor: pointer; font-weight: 600; }
@media print { details { display: block; } .notice { break-inside: avoid; } figure { break-inside: avoid; } }
)css";

const char* class_of(Notice kind) {
  return kind == Notice::information ? "information"
         : kind == Notice::warning   ? "warning"
                                     : "error";
}
const char* word_for(Notice kind) {
  return kind == Notice::information ? "Note: " : kind == Notice::warning ? "Warning: " : "Error: ";
}

std::string captioned(const std::string& content, const std::string& caption) {
  return "<figure>" + content +
         (caption.empty() ? "" : "<figcaption>" + escaped(caption) + "</figcaption>") +
         "</figure>\n";
}

}  // namespace

ReportWriter::ReportWriter(const std::string& title, const std::string& subtitle) : title_(title) {
  body_ = "<h1>" + escaped(title) + "</h1>\n";
  if (!subtitle.empty()) body_ += "<p class=\"subtitle\">" + escaped(subtitle) + "</p>\n";
}

void ReportWriter::heading(const std::string& text, int level) {
  require(level >= 2 && level <= 4, "report: heading level must be 2 to 4, got ", level);
  const std::string tag = join_text("h", level);
  body_ += "<" + tag + ">" + escaped(text) + "</" + tag + ">\n";
}

void ReportWriter::paragraph(const std::string& text) { body_ += "<p>" + escaped(text) + "</p>\n"; }

void ReportWriter::notice(Notice kind, const std::string& text) {
  body_ += join_text("<p class=\"notice ", class_of(kind), "\"><strong>", word_for(kind),
                     "</strong>", escaped(text), "</p>\n");
}

void ReportWriter::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += "<li>" + escaped(item) + "</li>\n";
  body_ += "</ul>\n";
}

void ReportWriter::table(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows,
                         const std::string& caption) {
  for (const auto& row : rows)
    require(row.size() == header.size(), "report: a row of ", row.size(), " cells under ",
            header.size(), " headings");
  body_ += "<div class=\"scroll\"><table>\n";
  if (!caption.empty()) body_ += "<caption>" + escaped(caption) + "</caption>\n";
  if (std::any_of(header.begin(), header.end(), [](const auto& cell) { return !cell.empty(); })) {
    body_ += "<thead><tr>";
    for (const std::string& cell : header) body_ += "<th scope=\"col\">" + escaped(cell) + "</th>";
    body_ += "</tr></thead>\n";
  }
  body_ += "<tbody>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      body_ += i == 0 ? "<th scope=\"row\">" + escaped(row[i]) + "</th>"
                      : "<td>" + escaped(row[i]) + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void ReportWriter::picture(const Image& image, const std::string& alternative,
                           const std::string& caption) {
  require(!alternative.empty(), "report: a picture needs a text alternative");
  body_ += captioned(
      join_text("<img alt=\"", escaped(alternative), "\" width=\"", image.width, "\" height=\"",
                image.height, "\" src=\"data:image/png;base64,", base64(encode_png(image)), "\">"),
      caption);
}

void ReportWriter::plot(const LinePlot& plot, const std::string& caption) {
  body_ += captioned(line_plot_svg(plot), caption);
}

void ReportWriter::begin_details(const std::string& summary) {
  body_ += "<details><summary>" + escaped(summary) + "</summary>\n";
  ++open_details_;
}

void ReportWriter::end_details() {
  require(open_details_ > 0, "report: no details are open");
  body_ += "</details>\n";
  --open_details_;
}

std::string ReportWriter::html() const {
  require(open_details_ == 0, "report: ", open_details_, " details are still open");
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
         "data:; style-src 'unsafe-inline'\">\n"
         "<title>" +
         escaped(title_) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n" +
         body_ + "</main>\n</body>\n</html>\n";
}

void ReportWriter::write(const std::filesystem::path& path) const { write_whole(path, html()); }

}  // namespace coxa::view
