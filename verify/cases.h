#pragma once

#include <coxa/mesh/tet_mesh.h>

#include <string>
#include <vector>

namespace coxa::verify {

/// One figure of a reference case beside the known answer.
struct Row {
  std::string name;
  double reference;
  double ours;
  double tolerance;        ///< relative to the reference
  std::string curve = {};  ///< y axis of the plot that it is a point of; empty: of none
  double at = 0.0;         ///< where on the x axis of that plot
};
using Rows = std::vector<Row>;

// the letters are those of docs/verification.md
Rows elastica();              // a
Rows self_weight();           // b
Rows st_venant_kirchhoff();   // c
Rows patch();                 // d
Rows contact_patch();         // e
Rows hertz();                 // f
Rows compressible_layer();    // g
Rows incompressible_layer();  // h
Rows ball_in_cup();           // i
Rows torsion();               // j
Rows biphasic();              // k
Rows cook();                  // l
Rows prony();                 // m
Rows energy();                // n
Rows curves();                // p
Rows viscosity();             // q
Rows strong_compression();    // r
Rows slope();                 // s

/// The rod of (a) and (b) in its straight shape: clamped at x = 0.
TetMesh rod_mesh();

}  // namespace coxa::verify
