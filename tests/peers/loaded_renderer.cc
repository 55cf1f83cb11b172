#include "tests/peers/loaded_renderer.h"

#include <array>
#include <cmath>

#include <dlfcn.h>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate::peers {
namespace {

template <class Function>
void look_up(void* library, const char* name, const std::string& file,
             Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) {
    throw InputError(fmt::format("renderer {} has no function {}()", file, name));
  }
}

}  // namespace

std::vector<std::string> Renderer::variants() const {
  std::vector<std::string> names;
  for (int i = 0; variant(i) != nullptr; ++i) {
    names.emplace_back(variant(i));
  }
  return names;
}

Renderer load_renderer(const std::filesystem::path& library) {
  const std::string file = std::filesystem::absolute(library).string();
  void* loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded == nullptr) {
    throw InputError(fmt::format("renderer {}: {}", file, dlerror()));
  }
  Renderer r;
  r.name = library.stem().string();
  for (const std::string_view prefix : {"lib", "peer_"}) {
    if (r.name.starts_with(prefix)) {
      r.name.erase(0, prefix.size());
    }
  }
  look_up(loaded, "peer_variant", file, r.variant);
  look_up(loaded, "peer_open", file, r.open);
  look_up(loaded, "peer_pose", file, r.pose);
  look_up(loaded, "peer_force", file, r.force);
  look_up(loaded, "peer_slow", file, r.slow);
  look_up(loaded, "peer_close", file, r.close);
  return r;
}

OpenTool::OpenTool(const Renderer& renderer, const std::string& variant,
                   const std::filesystem::path& scene, const std::filesystem::path& own,
                   double tick_s)
    : renderer_(renderer),
      tool_(nullptr, renderer.close),
      every_(static_cast<int>(std::lround(kSlowS / tick_s))) {
  std::array<char, 512> error{};
  tool_.reset(renderer.open(scene.c_str(), own.c_str(), variant.c_str(), tick_s,
                            error.data(), error.size()));
  if (tool_ == nullptr) {
    error.back() = '\0';
    throw InputError(error.front() != '\0' ? error.data() : "no reason given");
  }
}

void OpenTool::pose(const Eigen::Vector3d& position_m) const {
  constexpr std::array<double, 4> kUpright{0.0, 0.0, 0.0, 1.0};
  renderer_.pose(tool_.get(), position_m.data(), kUpright.data());
}

Eigen::Vector3d OpenTool::force() const {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  renderer_.force(tool_.get(), force_n.data());
  return force_n;
}

bool OpenTool::slow_is_due() {
  return ticks_++ % every_ == 0;
}

Eigen::Vector3d OpenTool::tick(const Eigen::Vector3d& position_m) {
  pose(position_m);
  const Eigen::Vector3d force_n = force();
  if (slow_is_due()) {
    slow();
  }
  return force_n;
}

}  // namespace palpate::peers
