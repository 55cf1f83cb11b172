#include "precompute/serve/work_board.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace palpate {
namespace {

// What a hand can reach while a preliminary group is computed.
constexpr double kAroundM = 0.02;

}  // namespace

WorkBoard::WorkBoard(const Points& position_m, std::vector<PreliminaryGroup> groups,
                     std::span<const WorkUnit> units)
    : position_m_(position_m),
      groups_(std::move(groups)),
      units_(units),
      group_state_(groups_.size(), State::kOpen),
      unit_state_(units.size(), State::kOpen),
      answered_(static_cast<std::size_t>(position_m.rows()), 0) {}

// [m] remoteness of the nearest of the vertices to the hand that it is nearest to.
double WorkBoard::need(std::span<const std::int32_t> vertices,
                       std::span<const HandPlace> hands) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const HandPlace& hand : hands) {
    for (const std::int32_t v : vertices) {
      nearest = std::min(nearest, remoteness_m(hand, position_m_.row(v).transpose()));
    }
  }
  return nearest;
}

std::optional<std::size_t> WorkBoard::nearest_group(
    std::span<const HandPlace> hands) const {
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (group_state_[i] == State::kOpen) {
      const double distance = need(groups_[i], hands);
      if (!best || distance < least) {
        best = i;
        least = distance;
      }
    }
  }
  return best;
}

std::vector<std::size_t> WorkBoard::units_by_need(
    std::span<const HandPlace> hands) const {
  std::vector<std::pair<std::pair<bool, double>, std::size_t>> order;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (unit_state_[i] == State::kOpen) {
      order.push_back({{units_[i].is_check,
                        units_[i].is_check ? 0.0 : need(units_[i].vertex, hands)},
                       i});
    }
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> units;
  for (const auto& [key, unit] : order) {
    units.push_back(unit);
  }
  return units;
}

bool WorkBoard::groups_come_first(std::size_t nearest, std::span<const HandPlace> hands,
                                  bool expected) const {
  if (hands.empty()) {
    return expected;
  }
  const bool all_rest =
      std::all_of(hands.begin(), hands.end(), [](const HandPlace& hand) {
        return hand.velocity_m_per_s.norm() < kRestingMPerS;
      });
  const bool somebody_takes_them = std::find(group_state_.begin(), group_state_.end(),
                                             State::kTaken) != group_state_.end();
  return !all_rest || !somebody_takes_them || need(groups_[nearest], hands) < kAroundM;
}

NextWork WorkBoard::next(std::span<const HandPlace> hands,
                         const std::function<bool(std::size_t)>& may_take,
                         bool expected) {
  const std::lock_guard lock(mutex_);
  const std::optional<std::size_t> group = nearest_group(hands);
  if (group && groups_come_first(*group, hands, expected)) {
    group_state_[*group] = State::kTaken;
    return {.group = group, .unit = {}};
  }
  for (const std::size_t unit : units_by_need(hands)) {
    if (may_take(unit)) {
      unit_state_[unit] = State::kTaken;
      return {.group = {}, .unit = unit};
    }
  }
  return {};
}

void WorkBoard::finish_group(std::size_t group) {
  const std::lock_guard lock(mutex_);
  group_state_[group] = State::kDone;
}

void WorkBoard::finish_unit(std::size_t unit) {
  const std::lock_guard lock(mutex_);
  unit_state_[unit] = State::kDone;
  if (units_[unit].is_check) {
    return;
  }
  for (const std::int32_t v : units_[unit].vertex) {
    answered_[static_cast<std::size_t>(v)] = 1;
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const bool all =
        std::all_of(groups_[i].begin(), groups_[i].end(), [&](std::int32_t v) {
          return answered_[static_cast<std::size_t>(v)] != 0;
        });
    if (all && group_state_[i] == State::kOpen) {
      group_state_[i] = State::kDone;
    }
  }
}

std::vector<std::size_t> WorkBoard::open_units() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < unit_state_.size(); ++i) {
    if (unit_state_[i] == State::kOpen) {
      open.push_back(i);
    }
  }
  return open;
}

std::size_t WorkBoard::unfinished() const {
  const std::lock_guard lock(mutex_);
  const auto done = std::count(unit_state_.begin(), unit_state_.end(), State::kDone);
  return unit_state_.size() - static_cast<std::size_t>(done);
}

}  // namespace palpate
