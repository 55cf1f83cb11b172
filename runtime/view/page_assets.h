// The files of the live view's page, compiled in (cmake/EmbedPage.cmake).
#pragma once

#include <span>

#include "runtime/view/view_server.h"

namespace palpate {

/// Every file of runtime/page; "/" is index.html.
[[nodiscard]] std::span<const ViewAsset> page_assets();

}  // namespace palpate
