#pragma once

#include <string>
#include <vector>

namespace coxa::verify {

/// One figure of a reference case beside the known answer.
struct Row {
  std::string name;
  double reference;
  double ours;
  double tolerance;  ///< relative to the reference
};
using Rows = std::vector<Row>;

// the letters are those of docs/verification.md
Rows elastica();              // a
Rows self_weight();           // b
Rows st_venant_kirchhoff();   // c
Rows patch();                 // d
Rows hertz();                 // f
Rows compressible_layer();    // g
Rows incompressible_layer();  // h
Rows cook();                  // l
Rows prony();                 // m
Rows energy();                // n
Rows curves();                // p
Rows viscosity();             // q
Rows strong_compression();    // r

}  // namespace coxa::verify
