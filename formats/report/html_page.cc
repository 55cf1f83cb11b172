#include "formats/report/html_page.h"

#include <cstdint>
#include <string_view>

#include "formats/base/json_text.h"
#include "formats/report/colour_map.h"

namespace palpate {
namespace {

// (nodes x 3) as singles.
std::vector<float> rows(const Points& points, const std::vector<std::int32_t>& nodes) {
  std::vector<float> values;
  for (const std::int32_t node : nodes) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      values.push_back(static_cast<float>(points(node, j)));
    }
  }
  return values;
}

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 |
              (i + j < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + j]) : 0);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
    }
  }
  return text;
}

nlohmann::ordered_json page_colours() {
  nlohmann::ordered_json stops = nlohmann::ordered_json::array();
  constexpr int kSteps = 32;
  for (int i = 0; i <= kSteps; ++i) {
    stops.push_back(hex(viridis(static_cast<double>(i) / kSteps)));
  }
  return stops;
}

std::string page_json(const std::string& id, const nlohmann::ordered_json& json) {
  std::string text = ascii_json_text(json);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<')) {
    text.replace(at, 1, "\\u003c");  // no text ends the script
  }
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id,
                     text);
}

std::string page_info(nlohmann::ordered_json info) {
  info["colours"] = page_colours();
  return page_json("info", info);
}

std::string page_script(std::initializer_list<std::string_view> parts) {
  std::string text = "<script>'use strict';\n";
  for (const std::string_view part : parts) {
    text += part;
  }
  return text + "</script>\n";
}

nlohmann::ordered_json page_box(const SurfaceMesh& body) {
  const Eigen::AlignedBox3d box = bounding_box(body);
  auto corners = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& p : {box.min(), box.max()}) {
    corners.push_back({p.x(), p.y(), p.z()});
  }
  return corners;
}

std::string page_body(const SurfaceMesh& body, const Points& normal,
                      const ThinBody& thin) {
  std::vector<std::int32_t> corner;
  for (const auto& triangle : thin.triangle.rowwise()) {
    corner.insert(corner.end(), {triangle[0], triangle[1], triangle[2]});
  }
  return page_array("position", rows(body.position_m, thin.node)) +
         page_array("normal", rows(normal, thin.node)) + page_array("triangle", corner);
}

}  // namespace palpate
