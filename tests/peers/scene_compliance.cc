#include "tests/peers/scene_compliance.h"

#include <fstream>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

// Contact nodes where the scene's tool may come, free to move.
std::vector<std::int32_t> nodes_in_reach(const Scene& scene, const BodyModel& model,
                                         double beyond_m) {
  std::vector<std::int32_t> nodes;
  for (std::size_t i = 0; i < model.contact.node.size(); ++i) {
    const ContactNode& node = model.contact.node[i];
    Eigen::AlignedBox3d box;
    if (scene.reach.box_m) {
      const Eigen::Vector3d more = Eigen::Vector3d::Constant(beyond_m);
      box = {scene.reach.box_m->min() - more, scene.reach.box_m->max() + more};
    }
    if ((box.isEmpty() || box.contains(node.position_m)) &&
        !is_held(scene, node.position_m)) {
      nodes.push_back(static_cast<std::int32_t>(i));
    }
  }
  return nodes;
}

}  // namespace

void make_compliance(const fs::path& folder, const fs::path& output) {
  constexpr double kSpacingOfRadius = 0.25;
  const Scene scene = read_scene(folder / "body.toml");
  const BodySource body = read_body(scene);
  const double radius_m = body.tool.front()->shape().radius_m;
  const UniformSurface fine = uniform_surface(body, kSpacingOfRadius * radius_m, 12000);
  const BodyModel model = make_body_model(scene, body, fine.surface);
  const auto nodes = nodes_in_reach(scene, model, radius_m);
  const SurfaceCompliance compliance(*model.factor, model.supports, model.contact,
                                     nodes, std::numeric_limits<double>::infinity(), {},
                                     [](std::size_t done) {
                                       fmt::print(stderr, "compliance: {}\n", done);
                                     });
  Eigen::Matrix3Xd position(3, static_cast<Eigen::Index>(nodes.size()));
  Eigen::Matrix3Xd normal = position;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const ContactNode& node = model.contact.node[static_cast<std::size_t>(nodes[i])];
    position.col(static_cast<Eigen::Index>(i)) = node.position_m;
    normal.col(static_cast<Eigen::Index>(i)) = node.normal;
  }
  const Eigen::MatrixXf matrix = compliance.among(nodes).cast<float>();
  const auto count = static_cast<std::int64_t>(nodes.size());
  std::ofstream out(output, std::ios::binary);
  const auto put = [&](const void* data, std::int64_t bytes) {
    out.write(static_cast<const char*>(data), bytes);
  };
  put(&count, sizeof count);
  put(position.data(), position.size() * std::int64_t{sizeof(double)});
  put(normal.data(), normal.size() * std::int64_t{sizeof(double)});
  put(matrix.data(), matrix.size() * std::int64_t{sizeof(float)});
  if (!out.flush()) {
    throw InputError(fmt::format("{}: cannot be written", output.string()));
  }
}

}  // namespace palpate::peers
