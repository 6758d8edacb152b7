#include <coxa/io/head_shape_file.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/files.h>

#include <iomanip>
#include <sstream>

namespace coxa::io {
namespace {

VecX vector_of(const std::vector<double>& values) {
  return VecX::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::string list_of(const VecX& values) {
  constexpr Eigen::Index kPerLine = 8;
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << '[';
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (k > 0) text << (k % kPerLine == 0 ? ",\n  " : ", ");
    text << values[k];
  }
  return text.str() + "]";
}

}  // namespace

motion::HeadShape read_head_shape(const std::filesystem::path& path) {
  const Table table = Table::read(path);
  motion::HeadShape shape;
  shape.degree = table.get<Index>("degree");
  shape.mean = vector_of(table.get<std::vector<double>>("mean"));
  shape.spread = vector_of(table.get<std::vector<double>>("spread"));
  shape.source = table.get<std::string>("source");
  table.finish();
  motion::check_head_shape(shape);
  return shape;
}

void write_head_shape(const std::filesystem::path& path, const motion::HeadShape& shape) {
  write_bytes(
      path, join_text("# How femoral heads differ from spheres, alike from person to person: "
                      "docs/motion.md section 2.\n# Written by coxa_verify_motion learn-heads.\n",
                      "degree = ", shape.degree, "\nmean = ", list_of(shape.mean),
                      "\nspread = ", list_of(shape.spread), "\nsource = \"", shape.source, "\"\n"));
}

}  // namespace coxa::io
