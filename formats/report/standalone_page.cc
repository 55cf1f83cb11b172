#include "formats/report/standalone_page.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/base/sha256.h"
#include "formats/report/gzip_bytes.h"
#include "formats/report/html_page.h"
#include "formats/report/page_assets.h"

namespace palpate {
namespace {

constexpr std::string_view kStart = "/standalone.js";
constexpr std::string_view kInside = "/inside.js";
constexpr std::string_view kTransport = "/transport.js";

std::string_view asset(std::string_view path) {
  const auto all = page_assets();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const ViewAsset& candidate) {
        return candidate.path == path;
      });
  if (found == all.end()) {
    throw std::logic_error(fmt::format("the page has no file {}", path));
  }
  return found->bytes;
}

// The page's HTML with `text` in place of its one `old`.
void put(std::string& html, std::string_view old, std::string_view text) {
  const std::size_t at = html.find(old);
  if (at == std::string::npos || html.find(old, at + 1) != std::string::npos) {
    throw std::logic_error(fmt::format("the page needs {:?} once", old));
  }
  html.replace(at, old.size(), text);
}

std::string block(std::string_view id, std::span<const std::byte> bytes) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id,
                     base64(gzip_bytes(bytes)));
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

// All modules by their paths, with inside.js in transport.js's place.
std::string modules() {
  nlohmann::ordered_json files;
  for (const ViewAsset& file : page_assets()) {
    if (file.path.ends_with(".js") && file.path != kInside && file.path != kStart) {
      files[std::string(file.path)] =
          file.path == kTransport ? asset(kInside) : file.bytes;
    }
  }
  return json_text(files);
}

// As a policy names what it lets run: nothing else does.
std::string named(std::string_view text) {
  Sha256 sum;
  sum.update(bytes_of(text));
  const std::string hex = sum.hex();
  std::vector<std::byte> digest;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    digest.push_back(static_cast<std::byte>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return "'sha256-" + base64(digest) + "'";
}

std::string policy_and_style(std::string_view style, const InversePorts& device) {
  return fmt::format(
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "script-src {} blob: 'wasm-unsafe-eval'; worker-src blob:; style-src {}; img-src "
      "data: blob:; media-src blob:; connect-src ws://127.0.0.1:{} "
      "ws://127.0.0.1:{}\">\n<style>{}</style>\n",
      named(asset(kStart)), named(style), device.states, device.events, style);
}

}  // namespace

std::string standalone_page(const StandaloneBody& body,
                            std::span<const std::byte> module) {
  const std::string style =
      fmt::format("{}{}", asset("/uplot.css"), asset("/page.css"));
  std::string html(asset("/"));
  put(html, "<link rel=\"stylesheet\" href=\"/uplot.css\">\n", "");
  put(html, "<link rel=\"stylesheet\" href=\"/page.css\">\n",
      policy_and_style(style, body.device));
  put(html, "<script type=\"module\" src=\"/app.js\"></script>\n", "");
  const nlohmann::ordered_json about = {
      {"name", body.name},
      {"tools", body.tools},
      {"left_out", body.left_out},
      {"device_ports",
       {{"states", body.device.states}, {"events", body.device.events}}}};
  put(html, "</body>",
      fmt::format("<!-- {}\n{} -->\n{}{}{}{}<script>{}</script>\n</body>",
                  asset("/vendor_licenses.txt"), asset("/module_licenses.txt"),
                  page_json("about", about), block("files", bytes_of(modules())),
                  block("module", module), block("database", body.flat),
                  asset(kStart)));
  return html;
}

}  // namespace palpate
