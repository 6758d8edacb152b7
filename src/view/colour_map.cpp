#include <coxa/view/colour_map.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace coxa::view {
namespace {

using Table = std::array<Colour, 33>;
// every eighth colour of the published maps (matplotlib, public domain dedication CC0)
constexpr Table kViridis{
    {{68, 1, 84},    {71, 13, 96},   {72, 24, 106},  {72, 35, 116},  {71, 45, 123},  {69, 55, 129},
     {66, 64, 134},  {62, 73, 137},  {59, 82, 139},  {55, 91, 141},  {51, 99, 141},  {47, 107, 142},
     {44, 114, 142}, {41, 122, 142}, {38, 130, 142}, {35, 137, 142}, {33, 145, 140}, {31, 152, 139},
     {31, 160, 136}, {34, 167, 133}, {40, 174, 128}, {50, 182, 122}, {63, 188, 115}, {78, 195, 107},
     {94, 201, 98},  {112, 207, 87}, {132, 212, 75}, {152, 216, 62}, {173, 220, 48}, {194, 223, 35},
     {216, 226, 25}, {236, 229, 27}, {253, 231, 37}}};
constexpr Table kCividis{
    {{0, 34, 78},     {0, 40, 91},     {0, 46, 106},    {5, 51, 113},    {26, 56, 111},
     {39, 62, 110},   {50, 67, 109},   {59, 73, 108},   {67, 78, 108},   {75, 84, 108},
     {83, 90, 109},   {90, 95, 110},   {97, 101, 111},  {104, 106, 113}, {111, 112, 115},
     {118, 118, 118}, {125, 124, 120}, {132, 130, 121}, {140, 136, 120}, {147, 142, 120},
     {155, 148, 118}, {163, 154, 116}, {171, 160, 114}, {180, 167, 111}, {188, 174, 108},
     {196, 180, 104}, {205, 187, 99},  {213, 194, 94},  {222, 201, 88},  {231, 209, 80},
     {240, 216, 70},  {249, 224, 58},  {254, 232, 56}}};
constexpr Colour kNoValue{200, 200, 200};

// muscles and other structures take these in turn, by name
constexpr std::array<Colour, 8> kOthers{{{204, 102, 119},
                                         {136, 204, 238},
                                         {221, 170, 51},
                                         {17, 119, 51},
                                         {170, 68, 153},
                                         {136, 34, 85},
                                         {153, 153, 51},
                                         {51, 34, 136}}};
// Okabe and Ito 2008, and Tol's muted set: told apart by every kind of colour vision
constexpr std::array<std::pair<std::string_view, Colour>, 13> kKnown{
    {{"femur", {230, 159, 0}},
     {"hip_bone", {86, 180, 233}},
     {"sacrum", {187, 187, 187}},
     {"patella", {204, 187, 68}},
     {"femoral_cartilage", {213, 94, 0}},
     {"acetabular_cartilage", {0, 158, 115}},
     {"acetabular_labrum", {204, 121, 167}},
     {"joint_capsule", {148, 148, 180}},
     {"iliofemoral_ligament", {240, 228, 66}},
     {"pubofemoral_ligament", {153, 221, 255}},
     {"ischiofemoral_ligament", {238, 136, 102}},
     {"ligament_of_head_of_femur", {170, 170, 0}},
     {"transverse_acetabular_ligament", {255, 170, 187}}}};

}  // namespace

Colour map_colour(ColourMap map, double share) {
  if (std::isnan(share)) return kNoValue;
  share = std::clamp(share, 0.0, 1.0);
  if (map == ColourMap::grey) return mixed(kBlack, kWhite, share);
  const Table& table = map == ColourMap::viridis ? kViridis : kCividis;
  const double place = share * (table.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), table.size() - 2);
  return mixed(table[below], table[below + 1], place - static_cast<double>(below));
}

Colour scale_colour(const ColourScale& scale, double value) {
  return map_colour(scale.map, (value - scale.low) / (scale.high - scale.low));
}

std::vector<double> nice_ticks(double low, double high, int n) {
  require(std::isfinite(low) && std::isfinite(high) && low < high, "no ticks between ", low,
          " and ", high);
  require(n >= 1, "nice_ticks: n must be at least 1, got ", n);
  const double rough = (high - low) / n, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double digit = rough / power;
  const double step = power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0)
    ticks.push_back(k == 0.0 ? 0.0 : k * step);
  return ticks;
}

std::string tick_label(double value, double step) {
  const int digits =
      std::clamp(static_cast<int>(-std::floor(std::log10(std::abs(step)) + 1e-9)), 0, 9);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

Image draw_colour_bar(const ColourScale& scale, int height, double text_size) {
  require(scale.low < scale.high, "colour scale from ", scale.low, " to ", scale.high,
          ": the range is empty");
  const auto ticks = nice_ticks(scale.low, scale.high);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : scale.high - scale.low;
  double widest = text_width(scale.label, text_size) - 30.0;
  for (double tick : ticks)
    widest = std::max(widest, text_width(tick_label(tick, step), text_size));
  const int margin = static_cast<int>(line_height(text_size)), bar = 22;
  const int top = 2 * margin, length = height - top - margin;
  require(length > 20, "a colour bar needs more than ", height, " pixels of height");
  Image image(bar + 14 + static_cast<int>(std::ceil(widest)), height);
  update_text(image, 0, 0, scale.label, kInk, text_size);
  for (int y = 0; y < length; ++y)
    update_fill(image, 0, top + y, bar, 1, map_colour(scale.map, 1.0 - (y + 0.5) / length));
  for (double tick : ticks) {
    const double y = top + length * (scale.high - tick) / (scale.high - scale.low);
    update_line(image, Vec2(bar, y), Vec2(bar + 5, y), kInk);
    update_text(image, bar + 8, y - 0.6 * text_size, tick_label(tick, step), kInk, text_size);
  }
  return image;
}

Colour structure_colour(std::string_view name) {
  for (const auto& [known, colour] : kKnown)
    if (known == name) return colour;
  std::size_t sum = 0;
  for (char c : name) sum = 31 * sum + static_cast<unsigned char>(c);
  return kOthers[sum % kOthers.size()];
}

std::string readable(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

}  // namespace coxa::view
