#include "runtime/view/view_request.h"

#include <algorithm>

#include "runtime/inverse/websocket_handshake.h"

namespace palpate {
namespace {

constexpr std::string_view kBlanks = " \t";

bool is_control(char letter) {
  return (static_cast<unsigned char>(letter) < 0x20 && letter != '\t') ||
         letter == 0x7f;
}

bool is_token(std::string_view text) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789!#$%&'*+-.^_`|~";
  return !text.empty() && text.find_first_not_of(kAllowed) == std::string_view::npos;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

bool read_first_line(std::string_view line, HttpRequest& request) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || last == first) {
    return false;
  }
  request.method = line.substr(0, first);
  request.target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  request.goes_on = version == "HTTP/1.1";
  return is_token(request.method) && !request.target.empty() &&
         request.target.find_first_of(kBlanks) == std::string::npos &&
         (request.goes_on || version == "HTTP/1.0");
}

bool read_field(std::string_view line, HttpRequest& request) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) {
    return false;
  }
  request.fields.emplace_back(lower_case(std::string(line.substr(0, colon))),
                              trimmed(line.substr(colon + 1)));
  const auto& [name, value] = request.fields.back();
  return name != "transfer-encoding" && (name != "content-length" || value == "0");
}

}  // namespace

std::string_view HttpRequest::only(std::string_view name) const {
  std::string_view found;
  int count = 0;
  for (const auto& [field, value] : fields) {
    if (field == name) {
      found = value;
      ++count;
    }
  }
  return count == 1 ? found : "";
}

bool HttpRequest::lists(std::string_view name, std::string_view item) const {
  for (const auto& [field, value] : fields) {
    std::string_view rest = field == name ? std::string_view(value) : "";
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(','), rest.size());
      if (lower_case(std::string(trimmed(rest.substr(0, end)))) == item) {
        return true;
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  return false;
}

bool HttpRequest::is_upgrade() const {
  return method == "GET" && lists("connection", "upgrade") &&
         lists("upgrade", "websocket");
}

std::optional<HttpRequest> parse_http_request(std::string_view head) {
  HttpRequest request;
  for (bool first = true; !head.empty(); first = false) {
    const std::size_t end = head.find("\r\n");
    const std::string_view line = head.substr(0, end);
    if (end == std::string_view::npos ||
        std::any_of(line.begin(), line.end(), is_control) ||
        !(first ? read_first_line(line, request) : read_field(line, request))) {
      return std::nullopt;
    }
    head.remove_prefix(end + 2);
  }
  request.goes_on = request.goes_on && !request.lists("connection", "close");
  return request.method.empty() ? std::nullopt : std::optional(std::move(request));
}

}  // namespace palpate
