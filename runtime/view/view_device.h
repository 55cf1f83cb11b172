// A device that a page has in its pointer's place.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/view/view_json.h"
#include "runtime/view/view_message.h"

namespace palpate {

/// One thread.
class ViewDevice {
 public:
  ViewDevice() = default;
  virtual ~ViewDevice() = default;
  ViewDevice(const ViewDevice&) = delete;
  ViewDevice& operator=(const ViewDevice&) = delete;

  /// The page wants to press with it (ViewAction::kDevice). @throws InputError for a
  /// body that it does not press.
  virtual void ask(const ViewRequest& request) = 0;

  /// From ask() until the device has been let go of, whoever did that.
  [[nodiscard]] virtual bool active() const = 0;

  /// Zero force, then gone. Nothing where it is not active.
  virtual void let_go(std::string_view why) = 0;

  /// Settings while it is active. @throws InputError for what it cannot render; then
  /// none is changed.
  virtual void set(const ViewRequest& request) = 0;

  /// Time has passed.
  virtual void watch(std::int64_t now_ns) = 0;

  [[nodiscard]] virtual ViewDeviceShown shown() const = 0;
};

}  // namespace palpate
