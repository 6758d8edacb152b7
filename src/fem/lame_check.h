#pragma once

#include <coxa/core/error.h>
#include <coxa/fem/material.h>

namespace coxa::fem {

/// @throws Error bad_input if a body of these parameters would not resist every small strain
inline void check(const Lame& lame) {
  require(lame.mu > 0.0 && lame.lambda + 2.0 / 3.0 * lame.mu > 0.0, "Lame parameters lambda ",
          lame.lambda, ", mu ", lame.mu, " MPa do not give a stable material");
}

}  // namespace coxa::fem
