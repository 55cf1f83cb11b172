// The live view's page in headless Chromium, against the real palpate-run. Debian's
// chromium-driver, python3-selenium and python3-websocket; skipped where they are
// absent. PALPATE_VIEW_PICTURES names a folder that gets pictures of the page.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "formats/hdf5_io.h"
#include "formats/response_database.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

[[maybe_unused]] const bool kQuietExit = (skip_hdf5_exit_cleanup(), true);

constexpr double kStiffness = 200.0;  // [N/m] of every node, without friction

bool has_browser() {
  return std::filesystem::exists("/usr/bin/chromium") &&
         std::filesystem::exists("/usr/bin/chromedriver") &&
         std::system("/usr/bin/python3 -c 'import selenium, websocket' 2>/dev/null") ==
             0;
}

nlohmann::json seen_on_page(const std::string& flags) {
  const ScratchFolder folder;
  write_database(folder / "plate.h5", sample_database(
                                          plate(0.1, 20), ball(0.008, 0.0, 0.0),
                                          [](Eigen::Index, double d) {
                                            return kStiffness * d;
                                          },
                                          0.01));
  const char* pictures = std::getenv("PALPATE_VIEW_PICTURES");
  const auto tool =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpate-run";
  const std::string command = fmt::format(
      "/usr/bin/python3 tests/system/view_page.py '{}' '{}' {} {}", tool.string(),
      (folder / "plate.h5").string(), pictures != nullptr ? pictures : "", flags);
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> piece{};
  for (std::size_t n = 0; (n = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;) {
    text.append(piece.data(), n);
  }
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return nlohmann::json::parse(text, nullptr, false);
}

double norm(const nlohmann::json& v) {
  return std::hypot(v.at(0).get<double>(), v.at(1).get<double>(),
                    v.at(2).get<double>());
}

TEST(ViewPage, PressesByMouseAndByKeysAndShowsTheRuntimesNumbers) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const nlohmann::json seen = seen_on_page("");
  ASSERT_TRUE(seen.is_object());
  EXPECT_EQ(seen["errors"], nlohmann::json::array());
  EXPECT_EQ(seen["watcher"], "watcher");
  EXPECT_EQ(seen["refusal"], "another page steers, this one watches");
  EXPECT_EQ(seen["address"].get<std::string>().find('#'), std::string::npos);
  EXPECT_NE(seen["without_token"].get<std::string>().find("token"), std::string::npos);

  // What stands on the page is what the runtime said to another page, rounded.
  const nlohmann::json& paused = seen["paused"];
  const double force_n = norm(paused["force_n"]);
  EXPECT_EQ(paused["shown_force_n"], fmt::format("{:.3f}", force_n));
  EXPECT_EQ(paused["shown_depth_mm"],
            fmt::format("{:.2f}", 1e3 * paused["depth_m"].get<double>()));
  EXPECT_EQ(paused["shown_energy_mj"],
            fmt::format("{:.3f}", 1e3 * paused["stored_j"].get<double>()));
  // And it is the body's response.
  EXPECT_NEAR(force_n, kStiffness * paused["depth_m"].get<double>(), 1e-3 * force_n);
  EXPECT_EQ(paused["fault"], "none");

  EXPECT_GT(seen["deeper_force_n"], seen["mouse_force_n"]);
  EXPECT_EQ(norm(seen["released_force_n"]), 0.0);
  EXPECT_GT(seen["keys_force_n"], 0.01);
  EXPECT_NE(seen["curve"].get<std::string>().find("slope 200 N/m"), std::string::npos)
      << seen["curve"];
  EXPECT_EQ(seen["exit_code"], 0);
}

TEST(ViewPage, WithoutWebGlNumbersAndKeysRemain) {
  if (!has_browser()) {
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, python3-websocket";
  }
  const nlohmann::json seen = seen_on_page("--no-3d");
  ASSERT_TRUE(seen.is_object());
  EXPECT_TRUE(seen["no_webgl"]);
  EXPECT_GT(seen["keys_force_n"], 0.01);
}

}  // namespace
}  // namespace palpate
