#pragma once

#include <string>

namespace coxa {

/// How an iterative solver ended. A solver that does not converge returns this, it does not throw.
struct SolveReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;  ///< relative unless the solver's docstring says otherwise
  std::string reason;     ///< why it stopped, empty when converged
};

}  // namespace coxa
