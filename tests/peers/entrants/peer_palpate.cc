// palpate by its C interface, every local model; the last variant with friction.
//
// A body that the scene gives as responses.h5 is taken as it is. Measured presses
// (session.toml) are fitted, materials (body.toml) are built, by palpate's tools with
// the scene's own accuracy.
#include "palpate.h"

#include <array>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "formats/database/response_database.h"
#include "tests/peers/entrants/entrant.h"
#include "tests/peers/entrants/scene_values.h"

namespace peers {
namespace {

namespace fs = std::filesystem;

constexpr double kForceMaxN = 1000.0;  // no scene reaches it: nothing is clamped
constexpr double kRampS = 1e-6;        // full force from the first tick

void run_tool(const std::string& command) {
  const std::string quiet =
      std::string(PALPATE_BIN_DIR) + "/" + command + " > /dev/null 2>&1";
  if (std::system(quiet.c_str()) != 0) {  // NOLINT(concurrency-mt-unsafe)
    throw std::runtime_error("this failed: " + command);
  }
}

std::string quoted(const fs::path& path) {
  return "'" + fs::absolute(path).string() + "'";
}

fs::path database_of(const fs::path& scene, const fs::path& own) {
  fs::path file = own / "body.h5";
  if (fs::exists(file)) {
    return file;
  }
  if (fs::exists(scene / "responses.h5")) {
    fs::copy_file(scene / "responses.h5", file);
  } else if (fs::exists(scene / "session.toml")) {
    run_tool("palpate-fit surface " + quoted(scene / "session.toml") + " -o " +
             quoted(file));
  } else {
    run_tool("palpate-precompute build " + quoted(scene / "body.toml") + " -o " +
             quoted(file));
  }
  return file;
}

// The same responses, with the scene's friction. Small: not counted as built.
fs::path with_friction(const fs::path& database, double friction, double presliding_m) {
  fs::path file = database;
  file.replace_filename("friction.h5");
  if (!fs::exists(file)) {
    palpate::ResponseDatabase changed = palpate::read_database(database);
    for (palpate::ResponseTable& table : changed.tools) {
      table.tool.friction = friction;
      table.tool.presliding_m = presliding_m;
      table.friction.assign(table.friction.size(), friction);
      table.presliding_m.assign(table.presliding_m.size(), presliding_m);
    }
    palpate::write_database(file, changed);
  }
  return file;
}

class Palpate {
 public:
  static constexpr const char* kVariants[] = {"potential",    "facets",
                                              "element",      "energy-tank",
                                              "equal-energy", "potential, friction"};

  Palpate(const fs::path& scene, const fs::path& own, const std::string& variant,
          double tick_s)
      : body_(nullptr, palpate_close) {
    fs::path file = database_of(scene, own);
    if (variant.ends_with("friction")) {
      const SceneValues values(scene);
      file =
          with_friction(file, values.number("friction"), values.number("presliding_m"));
    }
    const std::string model = variant.substr(0, variant.find(','));
    palpate_options options{};
    options.struct_size = sizeof options;
    options.nominal_tick_s = tick_s;
    options.force_max_n = kForceMaxN;
    options.ramp_s = kRampS;
    options.flags = PALPATE_OWN_SLOW_STEPS;
    options.model = model.c_str();
    std::array<char, 512> error{};
    body_.reset(palpate_open(file.c_str(), &options, error.data(), error.size()));
    tool_ =
        body_ ? palpate_tool_open(body_.get(), error.data(), error.size()) : nullptr;
    if (tool_ == nullptr) {
      throw std::runtime_error(error.data());
    }
  }

  void pose(const Eigen::Vector3d& position_m) { position_m_ = position_m; }

  Eigen::Vector3d force() {
    Eigen::Vector3d force_n;
    (void)palpate_force(tool_, position_m_.data(), nullptr, 0.0, force_n.data());
    return force_n;
  }

  void slow() { (void)palpate_slow_step(body_.get()); }

 private:
  std::unique_ptr<palpate_body, decltype(&palpate_close)> body_;
  palpate_tool* tool_ = nullptr;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
};

}  // namespace
}  // namespace peers

PEERS_ENTRANT(peers::Palpate)
