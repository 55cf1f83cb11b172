#include "formats/base/named_message.h"

#include <fmt/format.h>

namespace palpate {
namespace {

// Whether two paths can be of one file: equal, or one is the end of the other.
bool may_be_one_path(std::string_view a, std::string_view b) {
  const std::string_view longer = a.size() < b.size() ? b : a;
  const std::string_view shorter = a.size() < b.size() ? a : b;
  return !shorter.empty() && longer.ends_with(shorter) &&
         (longer.size() == shorter.size() ||
          longer[longer.size() - shorter.size() - 1] == '/');
}

}  // namespace

std::string_view without_name(std::string_view message, std::string_view name) {
  constexpr std::string_view kAfterPath = ": ";
  const std::string_view file = name.substr(0, name.rfind('#'));
  const std::size_t end = message.find(kAfterPath);
  if (end == std::string_view::npos) {
    return message;
  }
  const std::string_view path = message.substr(0, end);
  return may_be_one_path(path, name) || may_be_one_path(path, file)
             ? message.substr(end + kAfterPath.size())
             : message;
}

std::string with_name(std::string_view name, std::string_view message) {
  return fmt::format("{}: {}", name, without_name(message, name));
}

}  // namespace palpate
