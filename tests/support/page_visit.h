// A page on its own in a browser: Debian's headless Chromium.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace palpate {

struct PageVisit {
  nlohmann::json seen;
  std::string complaints;  ///< console messages and failures
};

/// The program to run, or empty: then skip.
[[nodiscard]] std::string page_browser();

/// Loads an HTML page from a file. @param script fills `seen`, an object; the number of
/// `requests` that the page made is added.
[[nodiscard]] PageVisit visit_page(const std::string& page, const std::string& script);

}  // namespace palpate
