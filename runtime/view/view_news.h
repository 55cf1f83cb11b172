// Of a body whose responses are still to come: what pages are told meanwhile. Who asks
// knows nothing of where they come from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "runtime/view/view_json.h"
#include "runtime/view/view_outbox.h"

namespace palpate {

/// One thread.
class ViewNews {
 public:
  ViewNews() = default;
  virtual ~ViewNews() = default;
  ViewNews(const ViewNews&) = delete;
  ViewNews& operator=(const ViewNews&) = delete;

  /// How the service is, for a frame.
  [[nodiscard]] virtual ViewService service() = 0;

  /// The next message of answers for the page, if it is time for one.
  [[nodiscard]] virtual std::optional<std::string> answers(ViewClient page,
                                                           std::int64_t now_ns) = 0;

  /// The page is gone.
  virtual void forget(ViewClient page) = 0;

  /// As curve_text(), of a node's answer so far. @throws InputError for a node that is
  /// not there.
  [[nodiscard]] virtual std::string curve(std::int32_t node) const = 0;

  /// The scene has changed: what is known was for another one.
  virtual void start_anew() = 0;
};

}  // namespace palpate
