#include "formats/base/json_text.h"

#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using Ordered = nlohmann::ordered_json;

constexpr auto kReplace = nlohmann::json::error_handler_t::replace;

}  // namespace

std::string json_text(const nlohmann::json& value, int indent) {
  return value.dump(indent, ' ', false, kReplace);
}

std::string json_text(const Ordered& value, int indent) {
  return value.dump(indent, ' ', false, kReplace);
}

std::string ascii_json_text(const Ordered& value) {
  return value.dump(-1, ' ', true, kReplace);
}

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

Ordered parse_ordered_json(std::string_view text) {
  return Ordered::parse(text, nullptr, false);
}

}  // namespace palpate
