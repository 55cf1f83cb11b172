// What HTML pages that need nothing else are made of.
#pragma once

#include <bit>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/mesh/surface_mesh.h"
#include "formats/report/display_mesh.h"

namespace palpate {

static_assert(std::endian::native == std::endian::little);  // as all browsers' arrays

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// Numbers for the page's script, which finds them by the id.
template <typename T>
[[nodiscard]] std::string page_array(const std::string& id,
                                     const std::vector<T>& values) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id,
                     base64(std::as_bytes(std::span(values))));
}

/// Stops of the colour map, from 0 to 1 in equal steps, as pages know colours.
[[nodiscard]] nlohmann::ordered_json page_colours();

/// JSON for the page's script, which finds it by the id.
[[nodiscard]] std::string page_json(const std::string& id,
                                    const nlohmann::ordered_json& json);

/// The element `info` that turnable_script reads; it asks for `box`. The colours are
/// added.
[[nodiscard]] std::string page_info(nlohmann::ordered_json info);

/// One script of several parts.
[[nodiscard]] std::string page_script(std::initializer_list<std::string_view> parts);

/// Two corners of the box around a body [m].
[[nodiscard]] nlohmann::ordered_json page_box(const SurfaceMesh& body);

/// The arrays that turnable_script draws. @param normal (n x 3)
[[nodiscard]] std::string page_body(const SurfaceMesh& body, const Points& normal,
                                    const ThinBody& thin);

}  // namespace palpate
