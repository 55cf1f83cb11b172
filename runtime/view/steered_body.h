// A body that pages steer tools on, and change: a seam, because a tool may touch at one
// place or at several.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/hand/pointer_hand.h"
#include "runtime/needle/channel.h"
#include "runtime/render/rendered_body.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_message.h"

namespace palpate {

/// A hand that a page steers, or nobody.
struct SteeredHand {
  const ResponseTable* table = nullptr;  ///< of its tool
  Eigen::Vector3d start_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();  ///< [-] at start_m
  PointerHand pointer{Eigen::Vector3d::Zero()};
  bool holding = false;
};

/// One thread.
class SteeredBody {
 public:
  SteeredBody() = default;
  virtual ~SteeredBody() = default;
  SteeredBody(const SteeredBody&) = delete;
  SteeredBody& operator=(const SteeredBody&) = delete;

  /// A new run begins, on the body as it was at the start; settings stay.
  virtual void begin() = 0;
  /// As begin() made it; valid until the next one.
  [[nodiscard]] virtual RenderedBody& rendered() = 0;
  [[nodiscard]] virtual const RenderedBody& rendered() const = 0;

  /// Other limits of force from the next begin() on. @param ramp_s as FastConfig's.
  virtual void limit(double force_max_n, double ramp_s) = 0;

  /// Model, stiffness, friction and coupling. @throws InputError for a setting that
  /// this body does not have; then none is changed.
  virtual void set(const ViewRequest& request) = 0;

  /// Where a hand's tool touches; -1: nowhere. @param latest tick
  [[nodiscard]] virtual std::int32_t triangle_under(std::size_t hand,
                                                    const TickRecord& latest) const = 0;

  /// The channel that a needle is in; none: in none.
  [[nodiscard]] virtual std::optional<Channel> channel() const { return {}; }

  /// Whether a hand can turn its tool.
  [[nodiscard]] virtual bool turns() const noexcept = 0;

  /// Model, stiffness and friction at the moment.
  virtual void tell(ViewSettings& settings) const = 0;

  /// What of a frame is this body's alone: contacts or hands, dents. `now` and `run`
  /// are there already. @param hand all hands.
  virtual void show(const std::vector<SteeredHand>& hand, ViewFrame& frame) = 0;
};

}  // namespace palpate
