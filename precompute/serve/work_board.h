// What is still to be computed for a scene, and what comes next for the hands that
// wait.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/serve/hand_places.h"

namespace palpate {

/// Vertices whose preliminary answers are computed together, for every tool.
using PreliminaryGroup = std::vector<std::int32_t>;

/// Either a group that wants preliminary answers, or a unit of work.
struct NextWork {
  std::optional<std::size_t> group;
  std::optional<std::size_t> unit;  ///< place among the units
};

/// Safe from several threads.
class WorkBoard {
 public:
  /// Places of a body's vertices; all must outlive the board.
  WorkBoard(const Points& position_m, std::vector<PreliminaryGroup> groups,
            std::span<const WorkUnit> units);

  /// While a hand moves, all workers give preliminary answers, along its way first; a
  /// unit keeps a worker for long. Where all hands rest, and what is around them is
  /// answered preliminarily, one worker goes on with that and others take units, the
  /// nearest first. Without hands, and once no groups are left, units alone are taken.
  /// Checks come last.
  /// @param may_take whether this process may compute the unit; asked in the order of
  /// need, for units that nobody works on. @returns neither if there is nothing to
  /// take.
  [[nodiscard]] NextWork next(std::span<const HandPlace> hands,
                              const std::function<bool(std::size_t)>& may_take,
                              bool expected = false);

  void finish_group(std::size_t group);
  /// Also one that another process has solved. Groups that it answers whole are done.
  void finish_unit(std::size_t unit);

  [[nodiscard]] const PreliminaryGroup& group(std::size_t i) const {
    return groups_[i];
  }
  [[nodiscard]] std::vector<std::size_t> open_units() const;  ///< nobody's here
  [[nodiscard]] std::size_t unfinished() const;               ///< units

 private:
  enum class State : std::uint8_t { kOpen, kTaken, kDone };

  [[nodiscard]] double need(std::span<const std::int32_t> vertices,
                            std::span<const HandPlace> hands) const;
  [[nodiscard]] std::optional<std::size_t> nearest_group(
      std::span<const HandPlace> hands) const;
  [[nodiscard]] std::vector<std::size_t> units_by_need(
      std::span<const HandPlace> hands) const;
  [[nodiscard]] bool groups_come_first(std::size_t nearest,
                                       std::span<const HandPlace> hands,
                                       bool expected) const;

  const Points& position_m_;
  std::vector<PreliminaryGroup> groups_;
  std::span<const WorkUnit> units_;
  mutable std::mutex mutex_;
  std::vector<State> group_state_;
  std::vector<State> unit_state_;
  std::vector<char> answered_;  // by vertex, well
};

}  // namespace palpate
