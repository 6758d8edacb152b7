#include <coxa/geom/triangle_tree.h>

#include <coxa/core/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace coxa {
namespace {

constexpr int kBins = 16;
constexpr Index kLeafSize = 4;
constexpr int kSurfaceAreaDepth = 40;  // below it, halves: the depth stays under 40 + 31

struct Box {
  Vec3 low = Vec3::Constant(kInfinity), high = Vec3::Constant(-kInfinity);
  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  double half_area() const {
    const Vec3 size = (high - low).cwiseMax(0.0);
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

struct Primitive {
  Box box;
  Vec3 centre;
  Index triangle;
};

struct Split {
  int axis = -1;
  double low = 0.0, scale = 0.0;
  int bin = 0;  // primitives in bins <= bin go left
  int bin_of(const Primitive& primitive) const {
    return std::min(kBins - 1, static_cast<int>((primitive.centre[axis] - low) * scale));
  }
};

// binned surface-area heuristic (Wald 2007) along the longest axis of the centres
Split best_split(std::vector<Primitive>& primitives, Index begin, Index end, const Box& centres) {
  Split split;
  const double extent = (centres.high - centres.low).maxCoeff(&split.axis);
  split.low = centres.low[split.axis];
  split.scale = kBins * (1.0 - 1e-12) / extent;
  std::array<Box, kBins> boxes;
  std::array<Index, kBins> counts{};
  for (Index i = begin; i < end; ++i) {
    const auto bin =
        static_cast<std::size_t>(split.bin_of(primitives[static_cast<std::size_t>(i)]));
    boxes[bin].add(primitives[static_cast<std::size_t>(i)].box);
    ++counts[bin];
  }
  std::array<double, kBins> right_cost{};
  Box box;
  Index count = 0;
  for (std::size_t bin = kBins - 1; bin > 0; --bin) {
    box.add(boxes[bin]);
    count += counts[bin];
    right_cost[bin] = count == 0 ? kInfinity : count * box.half_area();
  }
  box = {};
  count = 0;
  double best = kInfinity;
  for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
    box.add(boxes[bin]);
    count += counts[bin];
    if (count == 0) continue;
    const double cost = count * box.half_area() + right_cost[bin + 1];
    if (cost < best) {
      best = cost;
      split.bin = static_cast<int>(bin);
    }
  }
  return split;
}

// reorders [begin, end) into two parts and returns where the second starts
Index partition(std::vector<Primitive>& primitives, Index begin, Index end, int depth) {
  Box centres;
  for (Index i = begin; i < end; ++i) centres.add(primitives[static_cast<std::size_t>(i)].centre);
  const auto first = primitives.begin() + begin, last = primitives.begin() + end;
  const double extent = (centres.high - centres.low).maxCoeff();
  if (depth < kSurfaceAreaDepth && extent > 0.0 && std::isfinite(kBins / extent)) {
    const Split split = best_split(primitives, begin, end, centres);
    const auto middle = std::stable_partition(first, last, [&](const Primitive& primitive) {
      return split.bin_of(primitive) <= split.bin;
    });
    if (middle != first && middle != last) return static_cast<Index>(middle - primitives.begin());
  }
  return begin + (end - begin) / 2;
}

std::vector<Primitive> make_primitives(const Points& points, const Triangles& triangles) {
  std::vector<Primitive> primitives(static_cast<std::size_t>(triangles.rows()));
  for (Index t = 0; t < triangles.rows(); ++t) {
    Primitive& primitive = primitives[static_cast<std::size_t>(t)];
    for (int k = 0; k < 3; ++k) primitive.box.add(points.row(triangles(t, k)).transpose());
    primitive.centre = 0.5 * (primitive.box.low + primitive.box.high);
    primitive.triangle = t;
  }
  return primitives;
}

}  // namespace

TriangleTree::TriangleTree(Points points, Triangles triangles)
    : points_(std::move(points)), triangles_(std::move(triangles)) {
  if (triangles_.rows() == 0) fail(ErrorCode::bad_mesh, "the surface has no triangle");
  if (triangles_.minCoeff() < 0 || triangles_.maxCoeff() >= points_.rows())
    fail(ErrorCode::bad_mesh, "a triangle names vertex ",
         triangles_.minCoeff() < 0 ? triangles_.minCoeff() : triangles_.maxCoeff(),
         ", but vertices are numbered 0 to ", points_.rows() - 1);
  if (!points_.allFinite()) fail(ErrorCode::bad_mesh, "a vertex position is not finite");

  // triangles around each vertex
  ring_begin_.assign(static_cast<std::size_t>(points_.rows()) + 1, 0);
  for (Index i = 0; i < triangles_.size(); ++i)
    ++ring_begin_[static_cast<std::size_t>(triangles_.data()[i]) + 1];
  std::partial_sum(ring_begin_.begin(), ring_begin_.end(), ring_begin_.begin());
  ring_.resize(static_cast<std::size_t>(triangles_.size()));
  std::vector<Index> next = ring_begin_;
  for (Index i = 0; i < triangles_.size(); ++i)
    ring_[static_cast<std::size_t>(next[static_cast<std::size_t>(triangles_.data()[i])]++)] = i / 3;

  build();
  copy_corners();
  refit();
}

void TriangleTree::build() {
  std::vector<Primitive> primitives = make_primitives(points_, triangles_);
  struct Task {
    Index node;
    int depth;
  };
  nodes_.reserve(primitives.size());
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, 0, static_cast<Index>(primitives.size())});
  std::vector<Task> tasks{{0, 0}};
  while (!tasks.empty()) {
    const auto [number, depth] = tasks.back();
    tasks.pop_back();
    const Node node = nodes_[static_cast<std::size_t>(number)];
    if (node.end - node.begin <= kLeafSize) continue;
    const Index middle = partition(primitives, node.begin, node.end, depth);
    const auto child = static_cast<Index>(nodes_.size());
    nodes_[static_cast<std::size_t>(number)].child = child;
    nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, node.begin, middle});
    nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, middle, node.end});
    tasks.push_back({child + 1, depth + 1});
    tasks.push_back({child, depth + 1});
  }
  order_.reserve(primitives.size());
  for (const Primitive& primitive : primitives) order_.push_back(primitive.triangle);
}

void TriangleTree::copy_corners() {
  corners_.resize(9 * order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i)
    for (std::size_t k = 0; k < 9; ++k)
      corners_[9 * i + k] =
          points_(triangles_(order_[i], static_cast<Index>(k / 3)), static_cast<Index>(k % 3));
}

void TriangleTree::refit() {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    Box box;
    if (node->child != 0) {
      const Node& left = nodes_[static_cast<std::size_t>(node->child)];
      const Node& right = nodes_[static_cast<std::size_t>(node->child) + 1];
      box = {left.low.cwiseMin(right.low), left.high.cwiseMax(right.high)};
    } else {
      for (Index i = 3 * node->begin; i < 3 * node->end; ++i)
        box.add(Eigen::Map<const Vec3>(&corners_[3 * static_cast<std::size_t>(i)]));
    }
    node->low = box.low;
    node->high = box.high;
  }
}

void TriangleTree::update_points(const Points& points) {
  require(points.rows() == points_.rows(), "the tree holds ", points_.rows(), " vertices, got ",
          points.rows(), " positions");
  require(points.allFinite(), "a vertex position is not finite");
  points_ = points;
  copy_corners();
  refit();
}

}  // namespace coxa
