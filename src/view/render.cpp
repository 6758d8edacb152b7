#include <coxa/view/render.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <coxa/mesh/vertex_normals.h>

#include <embree3/rtcore.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace coxa::view {
namespace {

constexpr int kMaxLayers = 16;  // transparent surfaces followed behind one pixel

void check(const SceneMesh& part) {
  require(part.vertex_values.size() == 0 || part.vertex_values.size() == part.mesh.n_vertices(),
          "render: ", part.vertex_values.size(), " values for ", part.mesh.n_vertices(),
          " vertices");
  require(
      part.triangle_values.size() == 0 || part.triangle_values.size() == part.mesh.n_triangles(),
      "render: ", part.triangle_values.size(), " values for ", part.mesh.n_triangles(),
      " triangles");
  require(0.0 <= part.opacity && part.opacity <= 1.0, "render: opacity must be in [0, 1], got ",
          part.opacity);
  require(0.0 <= part.relief && part.relief <= 1.0, "render: relief must be in [0, 1], got ",
          part.relief);
  require(part.scale.low < part.scale.high, "render: the colour scale from ", part.scale.low,
          " to ", part.scale.high, " is empty");
  const bool in_range =
      part.mesh.empty() || (part.mesh.triangles.minCoeff() >= 0 &&
                            part.mesh.triangles.maxCoeff() < part.mesh.n_vertices());
  require(in_range, "render: a triangle names a vertex that is not there");
}

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
using SceneTree = std::unique_ptr<RTCSceneTy, Release>;

struct Ray {
  Vec3 origin, direction;
  double from = 0.0;
};

struct Hit {
  std::size_t part = 0;
  Index triangle = 0;
  Vec3 barycentric = Vec3::Zero();
  double distance = 0.0;
};

class Tracer {
 public:
  Tracer(const std::vector<SceneMesh>& scene, const Vec3& centre)
      : scene_(scene), centre_(centre), device_(rtcNewDevice("set_affinity=0")) {
    COXA_ASSERT(device_ != nullptr);
    tree_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(tree_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < scene.size(); ++i) {
      attach(scene[i].mesh, static_cast<unsigned>(i));
      normals_.push_back(vertex_normals(scene[i].mesh));
    }
    rtcCommitScene(tree_.get());
  }

  std::optional<Hit> first_hit(const Ray& ray) const {
    RTCRayHit query{};
    const Eigen::Vector3f origin = (ray.origin - centre_).cast<float>(),
                          direction = ray.direction.cast<float>();
    query.ray = {origin[0],
                 origin[1],
                 origin[2],
                 static_cast<float>(ray.from),
                 direction[0],
                 direction[1],
                 direction[2],
                 0.0f,
                 std::numeric_limits<float>::infinity(),
                 ~0u,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(tree_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const double u = query.hit.u, v = query.hit.v;
    return Hit{query.hit.geomID, static_cast<Index>(query.hit.primID), Vec3(1.0 - u - v, u, v),
               query.ray.tfar};
  }

  // linear RGB in [0, 255] seen along the ray
  Vec3 colour_along(Ray ray, const Vec3& background) const {
    Vec3 seen = Vec3::Zero();
    double clear = 1.0;
    for (int layer = 0; layer < kMaxLayers && clear > 1e-3; ++layer) {
      const std::optional<Hit> hit = first_hit(ray);
      if (!hit) break;
      const double opacity = scene_[hit->part].opacity;
      seen += clear * opacity * shaded(*hit, ray.direction);
      clear *= 1.0 - opacity;
      ray.from = hit->distance * (1.0 + 1e-6) + 1e-4;
    }
    return seen + clear * background;
  }

 private:
  void attach(const TriMesh& mesh, unsigned number) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                static_cast<std::size_t>(mesh.n_vertices())));
    auto* corners = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                static_cast<std::size_t>(mesh.n_triangles())));
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      for (int k = 0; k < 3; ++k)
        points[3 * v + k] = static_cast<float>(mesh.points(v, k) - centre_[k]);
    for (Index i = 0; i < mesh.triangles.size(); ++i)
      corners[i] = static_cast<unsigned>(mesh.triangles.data()[i]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree_.get(), geometry, number);
    rtcReleaseGeometry(geometry);
  }

  Vec3 shaded(const Hit& hit, const Vec3& direction) const {
    const SceneMesh& part = scene_[hit.part];
    Vec3 normal = Vec3::Zero();
    double value = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Index v = part.mesh.triangles(hit.triangle, k);
      normal += hit.barycentric[k] * normals_[hit.part].row(v).transpose();
      if (part.vertex_values.size() > 0) value += hit.barycentric[k] * part.vertex_values[v];
    }
    Colour colour = part.colour;
    if (part.vertex_values.size() > 0)
      colour = scale_colour(part.scale, value);
    else if (part.triangle_values.size() > 0)
      colour = scale_colour(part.scale, part.triangle_values[hit.triangle]);
    const double facing = std::abs(normal.normalized().dot(direction));
    return (1.0 - part.relief * (1.0 - facing)) * Vec3(colour.r, colour.g, colour.b);
  }

  const std::vector<SceneMesh>& scene_;
  Vec3 centre_;
  Device device_;
  SceneTree tree_;
  std::vector<Points> normals_;
};

}  // namespace

Vec3 Camera::right() const { return direction.cross(up); }

Camera camera_for(const Points& points, const Vec3& direction, const Vec3& up, double aspect) {
  require(points.rows() > 0, "camera_for: no point to show");
  require(aspect > 0.0, "camera_for: aspect must be positive, got ", aspect);
  require(
      direction.norm() > 0.0 && direction.cross(up).norm() > 1e-9 * direction.norm() * up.norm(),
      "camera_for: up must not be parallel to the direction of view");
  Camera camera;
  camera.direction = direction.normalized();
  camera.up = (up - up.dot(camera.direction) * camera.direction).normalized();
  const VecX across = points * camera.right(), upward = points * camera.up;
  const double width = across.maxCoeff() - across.minCoeff(),
               height = upward.maxCoeff() - upward.minCoeff();
  camera.view_height = 1.06 * std::max({height, width / aspect, 1e-6});
  camera.target = 0.5 * (across.maxCoeff() + across.minCoeff()) * camera.right() +
                  0.5 * (upward.maxCoeff() + upward.minCoeff()) * camera.up +
                  (points * camera.direction).mean() * camera.direction;
  return camera;
}

Vec2 project(const Camera& camera, const Vec3& point, int width, int height) {
  const double scale = height / camera.view_height;
  const Vec3 offset = point - camera.target;
  return {0.5 * width + scale * offset.dot(camera.right()),
          0.5 * height - scale * offset.dot(camera.up)};
}

Image render(const std::vector<SceneMesh>& scene, const Camera& camera,
             const RenderOptions& options) {
  require(options.width > 0 && options.height > 0, "render: picture of ", options.width, " x ",
          options.height, " pixels");
  require(options.samples >= 1, "render: samples must be at least 1, got ", options.samples);
  require(camera.view_height > 0.0, "render: view_height must be positive, got ",
          camera.view_height, " mm");
  double reach = camera.view_height;
  for (const SceneMesh& part : scene) {
    check(part);
    if (part.mesh.n_vertices() > 0)
      reach = std::max(
          reach,
          (part.mesh.points.rowwise() - camera.target.transpose()).rowwise().norm().maxCoeff());
  }
  const Tracer tracer(scene, camera.target);
  const Vec3 background(options.background.r, options.background.g, options.background.b);
  const double pixel = camera.view_height / options.height;
  Image image(options.width, options.height, options.background);
  parallel_for(options.height, [&](Index y) {
    for (int x = 0; x < options.width; ++x) {
      Vec3 sum = Vec3::Zero();
      for (int s = 0; s < options.samples * options.samples; ++s) {
        const double across =
            x + (s % options.samples + 0.5) / options.samples - 0.5 * options.width;
        const double down =
            y + (s / options.samples + 0.5) / options.samples - 0.5 * options.height;
        const Vec3 origin = camera.target + pixel * (across * camera.right() - down * camera.up) -
                            1.1 * reach * camera.direction;
        sum += tracer.colour_along({origin, camera.direction}, background);
      }
      const Vec3 mean = (sum / (options.samples * options.samples)).cwiseMax(0.0).cwiseMin(255.0);
      const auto channel = [&](int k) { return static_cast<std::uint8_t>(std::lround(mean[k])); };
      image.at(x, static_cast<int>(y)) = {channel(0), channel(1), channel(2)};
    }
  });
  return image;
}

}  // namespace coxa::view
