#pragma once

#include <coxa/view/image.h>
#include <coxa/view/render.h>

#include <string>
#include <vector>

namespace coxa::view {

inline constexpr double kTextSize = 14.0;

/// Letters of the patient directions (LPS) nearest to a vector: R L A P S I, two where it is
/// oblique ("AL").
std::string direction_letters(const Vec3& direction);

/// Writes the letters of the picture's four sides at their middles.
void update_side_letters(Image& image, const Vec3& right, const Vec3& up, Colour colour);

/// Scale bar of a round length in the lower left corner.
void update_scale_bar(Image& image, double mm_per_pixel, Colour colour);

/// Coloured names in rows no wider than `width`.
Image draw_legend(const std::vector<std::string>& names, int width);

/// The picture under a line of title.
Image titled(const Image& image, const std::string& title);

}  // namespace coxa::view
