// Physics against closed forms and published figures: one line a figure, exit code 1 when one is
// outside. Usage: coxa_verify [--csv FILE] [letters], for example "coxa_verify a h"; without
// letters, every case. "coxa_verify --rod-mesh rod.inp" only writes the rod's mesh.
#include <coxa/core/error.h>
#include <coxa/io/tets.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iomanip>
#include <optional>
#include <string>

#include "cases.h"

namespace {

struct Case {
  char letter;
  const char* title;
  std::function<coxa::verify::Rows()> run;
};

const std::vector<Case>& cases() {
  using namespace coxa::verify;
  static const std::vector<Case> all{
      {'a', "cantilever under an end load (elastica)", elastica},
      {'b', "cantilever under its own weight", self_weight},
      {'c', "St-Venant-Kirchhoff curves and collapse", st_venant_kirchhoff},
      {'d', "patch test on an irregular mesh", patch},
      {'e', "contact patch test, meshes that do not match", contact_patch},
      {'f', "rigid sphere on a half space (Hertz)", hertz},
      {'g', "rigid sphere on a bonded compressible layer", compressible_layer},
      {'h', "rigid sphere on a bonded nearly incompressible layer", incompressible_layer},
      {'i', "ball in a congruent cup", ball_in_cup},
      {'j', "twisted cylinder", torsion},
      {'k', "biphasic cartilage, confined and unconfined", biphasic},
      {'l', "Cook's membrane", cook},
      {'m', "relaxation by a Prony series", prony},
      {'n', "energy and frequency of free vibration", energy},
      {'p', "strain-stress curves, unrotated and rotated mode", curves},
      {'q', "viscosity by rate curves", viscosity},
      {'r', "strong compression", strong_compression},
      {'s', "friction on a slope", slope}};
  return all;
}

double error_of(const coxa::verify::Row& row) {
  const double scale = row.reference != 0.0 ? std::abs(row.reference) : 1.0;
  return std::abs(row.ours - row.reference) / scale;
}

/// Prints the rows of one case; returns how many are outside.
int report(const coxa::verify::Rows& rows) {
  int outside = 0;
  for (const auto& row : rows) {
    const double error = error_of(row);
    const bool inside = error <= row.tolerance;
    outside += inside ? 0 : 1;
    std::printf("  %-58s %14.8g %14.8g %9.2e %9.1e  %s\n", row.name.c_str(), row.reference,
                row.ours, error, row.tolerance, inside ? "pass" : "FAIL");
  }
  return outside;
}

/// The table that tools/plot_verification.py draws.
class Table {
 public:
  explicit Table(const std::string& path) : file_(path) {
    coxa::require(file_.good(), "cannot write ", path);
    file_ << std::setprecision(12) << "case,title,figure,reference,ours,error,tolerance,curve,at\n";
  }
  void write(const Case& one, const coxa::verify::Rows& rows) {
    for (const auto& row : rows)
      file_ << one.letter << ",\"" << one.title << "\",\"" << row.name << "\"," << row.reference
            << ',' << row.ours << ',' << error_of(row) << ',' << row.tolerance << ",\"" << row.curve
            << "\"," << row.at << '\n';
  }

 private:
  std::ofstream file_;
};

}  // namespace

int main(int argc, char** argv) {
  std::string chosen;
  std::optional<Table> table;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--csv" && k + 1 < argc) {
      table.emplace(argv[++k]);
    } else if (word == "--rod-mesh" && k + 1 < argc) {
      coxa::io::write_tets(argv[++k], coxa::verify::rod_mesh());
      return 0;
    } else {
      chosen += word;
    }
  }
  std::printf("%-60s %14s %14s %9s %9s\n", "case", "reference", "ours", "error", "tolerance");
  int outside = 0;
  std::size_t figures = 0;
  for (const Case& one : cases()) {
    if (!chosen.empty() && chosen.find(one.letter) == std::string::npos) continue;
    std::printf("(%c) %s\n", one.letter, one.title);
    std::fflush(stdout);
    const auto start = std::chrono::steady_clock::now();
    try {
      const auto rows = one.run();
      outside += report(rows);
      if (table) table->write(one, rows);
      figures += rows.size();
    } catch (const coxa::Error& error) {
      std::printf("  FAIL: %s\n", error.what());
      ++outside;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("  %.1f s\n", seconds.count());
  }
  std::printf("%zu figures, %d outside\n", figures, outside);
  return outside == 0 ? 0 : 1;
}
