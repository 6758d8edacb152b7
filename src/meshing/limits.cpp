#include "limits.h"

namespace coxa::meshing {
namespace {

int limits_missed(const MeshingReport& report) {
  const TetQuality& q = report.quality;
  return (q.aspect_mean < 0.72) + (q.aspect_p05 < 0.5) + (q.aspect_min < 0.15) +
         (q.dihedral_min < radians(10.0)) + (q.dihedral_max > radians(165.0)) +
         (report.envelope > 0.3);
}

}  // namespace

bool meets_limits(const MeshingReport& report) { return limits_missed(report) == 0; }

bool nearer_to_limits(const MeshingReport& a, const MeshingReport& b) {
  const int missed_a = limits_missed(a), missed_b = limits_missed(b);
  return missed_a < missed_b || (missed_a == missed_b && a.envelope < b.envelope);
}

}  // namespace coxa::meshing
