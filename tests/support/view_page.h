// The live view's page in headless Chromium, against the real palpate-run, driven by
// tests/system/view_page.py. Debian's chromium-driver, python3-selenium and
// python3-websocket; skip where they are absent. PALPATE_VIEW_PICTURES names a folder
// that gets pictures of the page.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/test_data.h"

namespace palpate {

/// Places are drawn as singles of a body of 0.1 m, states change until the page pauses.
inline constexpr double kDrawnM = 1e-5;

inline bool has_browser() {
  return std::filesystem::exists("/usr/bin/chromium") &&
         std::filesystem::exists("/usr/bin/chromedriver") &&
         std::system("/usr/bin/python3 -c 'import selenium, websocket' 2>/dev/null") ==
             0;
}

/// What the script saw. @param page its first two words
inline nlohmann::json scripted(const std::string& page, const std::string& flags) {
  const char* pictures = std::getenv("PALPATE_VIEW_PICTURES");
  const std::string command =
      fmt::format("/usr/bin/python3 tests/system/view_page.py {} {} {}", page,
                  pictures != nullptr ? pictures : "", flags);
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> piece{};
  for (std::size_t n = 0; (n = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;) {
    text.append(piece.data(), n);
  }
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return parse_json(text);
}

/// What the script saw of a database. @param flags of the script.
inline nlohmann::json seen_on_page(const ResponseDatabase& database,
                                   const std::string& flags) {
  const ScratchFolder folder;
  write_database(folder / "plate.h5", database);
  const auto tool =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpate-run";
  return scripted(
      fmt::format("'{}' '{}'", tool.string(), (folder / "plate.h5").string()), flags);
}

inline double norm(const nlohmann::json& v) {
  return std::hypot(v.at(0).get<double>(), v.at(1).get<double>(),
                    v.at(2).get<double>());
}

}  // namespace palpate
