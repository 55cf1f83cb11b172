// Pages of their own in headless Chromium, from a file, driven by the script of
// view_page.h. The module is share/palpate/palpate.wasm beside bin/, or what
// PALPATE_PAGE_MODULE names; it is built by ./bootstrap page.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "formats/base/input_file.h"
#include "formats/report/page_export.h"
#include "tests/support/view_page.h"

namespace palpate {

inline std::filesystem::path page_module_file() {
  const char* const named = std::getenv("PALPATE_PAGE_MODULE");
  return named != nullptr
             ? named
             : std::filesystem::read_symlink("/proc/self/exe").parent_path() /
                   "../share/palpate/palpate.wasm";
}

/// What the script saw of a page. @param flags of the script.
inline nlohmann::json seen_on_file(const std::string& html, const std::string& flags) {
  const ScratchFolder folder;
  std::ofstream(folder / "body.html", std::ios::binary) << html;
  return scripted("--own '" + (folder / "body.html").string() + "'", flags);
}

/// What the script saw of the database's own page. @param device ports of a service
inline nlohmann::json seen_on_own_page(const ResponseDatabase& database,
                                       const std::vector<std::string>& tools,
                                       const std::string& flags,
                                       const InversePorts& device = {}) {
  const std::string module = read_file(page_module_file());
  return seen_on_file(
      page_of(database, "body.h5", tools, std::as_bytes(std::span(module)), device)
          .html,
      flags);
}

}  // namespace palpate
