// The files of the live view's page, compiled in (cmake/EmbedPage.cmake).
#pragma once

#include <span>
#include <string_view>

namespace palpate {

/// A file of the page, for everybody who names the right host.
struct ViewAsset {
  std::string_view path;  ///< as asked for, "/page.css"
  std::string_view content_type;
  std::string_view bytes;  ///< must outlive the server
};

/// Every file of runtime/view/page; "/" is index.html.
[[nodiscard]] std::span<const ViewAsset> page_assets();

}  // namespace palpate
