#pragma once

#include <coxa/view/image.h>
#include <coxa/view/line_plot.h>

#include <filesystem>
#include <string>
#include <vector>

namespace coxa::view {

/// How serious a notice in a report is.
enum class Notice { information, warning, error };

/// A web page in one file: pictures are inside it, nothing is loaded from elsewhere, no script.
///
/// Follows the reader's choice of light or dark; every picture has a text alternative; all text is
/// escaped.
class ReportWriter {
 public:
  /// @param title  of the page   @param subtitle  for example patient, side and date; may be empty
  ReportWriter(const std::string& title, const std::string& subtitle);

  /// @param level  2 for sections, 3 for parts of a section
  void heading(const std::string& text, int level = 2);
  void paragraph(const std::string& text);
  void notice(Notice kind, const std::string& text);
  void list(const std::vector<std::string>& items);
  /// @param rows     each as long as `header`
  /// @throws Error   bad_input if a row has another length
  void table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows, const std::string& caption = {});
  /// @param alternative  what the picture shows, for those who cannot see it   @throws Error
  /// bad_input if empty
  void picture(const Image& image, const std::string& alternative, const std::string& caption = {});
  void plot(const LinePlot& plot, const std::string& caption = {});
  /// What follows until `end_details` is folded away under the summary.
  void begin_details(const std::string& summary);
  void end_details();

  /// The page so far, complete. @throws Error bad_input while details are open
  std::string html() const;
  /// Writes it; the file appears whole or not at all. @throws Error bad_file if it cannot be
  /// written
  void write(const std::filesystem::path& path) const;

 private:
  std::string title_;
  std::string body_;
  int open_details_ = 0;
};

}  // namespace coxa::view
