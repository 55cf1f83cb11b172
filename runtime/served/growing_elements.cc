#include "runtime/served/growing_elements.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Geometry>

#include "formats/response/tool_support.h"
#include "runtime/element/element_cache.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

// Triangles sent last that the fast process may still have: its cache keeps the newest,
// and the one in use; more of them where some were lost on the way.
constexpr std::size_t kHeld = 2 * kCacheSlots;

}  // namespace

bool GrowingElements::Sent::has(std::int32_t t) const noexcept {
  const auto end = triangle.begin() + static_cast<std::ptrdiff_t>(count);
  return std::find(triangle.begin(), end, t) != end;
}

GrowingElements::GrowingElements(const SurfaceMesh& body, const Points& normal,
                                 const ToolShape& tool, double stiffness_max_n_per_m)
    : body_(body),
      normal_(normal),
      tool_(tool),
      stiffness_max_n_per_m_(stiffness_max_n_per_m),
      height_m_(nominal_height_m(tool)),
      search_(body),
      around_begin_(static_cast<std::size_t>(body.position_m.rows()) + 1, 0),
      around_(static_cast<std::size_t>(body.triangle.size())),
      node_(static_cast<std::size_t>(body.position_m.rows())),
      held_mark_(static_cast<std::size_t>(body.triangle.rows()), 0) {
  for (Eigen::Index i = 0; i < body.triangle.size(); ++i) {
    ++around_begin_[static_cast<std::size_t>(body.triangle.data()[i]) + 1];
  }
  for (std::size_t i = 1; i < around_begin_.size(); ++i) {
    around_begin_[i] += around_begin_[i - 1];
  }
  std::vector<std::int32_t> next(around_begin_.begin(), around_begin_.end() - 1);
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto node = static_cast<std::size_t>(body.triangle(t, j));
      around_[static_cast<std::size_t>(next[node]++)] = static_cast<std::int32_t>(t);
    }
  }
  held_.reserve(kHeld + 1);
}

void GrowingElements::hand_over(std::vector<GrownNode> answers) {
  for (GrownNode& answer : answers) {
    softened_ += soften(answer.message, stiffness_max_n_per_m_) < 1.0 ? 1 : 0;
    stiffest_ = std::max(stiffest_.load(), stiffness_n_per_m(answer.message));
  }
  const std::lock_guard lock(mutex_);
  waiting_.insert(waiting_.end(), std::make_move_iterator(answers.begin()),
                  std::make_move_iterator(answers.end()));
}

void GrowingElements::take_in() {
  if (outdated_.exchange(false)) {
    while (next_taken_ < taken_.size()) {  // of the scene before, too
      take_in(taken_[next_taken_++]);
    }
    for (Node& node : node_) {
      node.known = GrownQuality::kNone;
      node.rendered = std::min(node.rendered, GrownQuality::kPreliminary);
    }
  }
  if (next_taken_ == taken_.size()) {
    taken_.clear();
    next_taken_ = 0;
    if (mutex_.try_lock()) {  // else at the next update
      taken_.swap(waiting_);
      mutex_.unlock();
    }
  }
  for (std::size_t i = 0; i < kAnUpdate && next_taken_ < taken_.size(); ++i) {
    take_in(taken_[next_taken_++]);
  }
}

void GrowingElements::take_in(const GrownNode& answer) {
  if (answer.node < 0 || answer.node >= std::ssize(node_)) {
    return;
  }
  Node& node = node_[static_cast<std::size_t>(answer.node)];
  if (answer.quality < node.known) {
    return;
  }
  node.known = answer.quality;
  if (node.pending == nullptr) {
    pending_.push_back(answer.node);
  }
  // One on its way goes on from where it is.
  node.pending = std::make_unique<Pending>(
      Pending{.quality = answer.quality, .to = answer.message, .blend = nullptr});
}

ElementNode GrowingElements::message(std::int32_t node) const {
  const Node& at = node_[static_cast<std::size_t>(node)];
  if (at.now != nullptr) {
    return *at.now;
  }
  ElementNode none;
  none.node = node;
  none.position_m = row_array(body_.position_m, node);
  none.normal = row_array(normal_, node);
  none.friction = tool_.friction;
  none.presliding_m = tool_.presliding_m;
  return none;
}

Element GrowingElements::element(std::int32_t triangle) const {
  Element element;
  element.triangle = triangle;
  element.touch_height_m = nominal_height_m(tool_);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    element.node[j] = message(body_.triangle(triangle, column));
    element.neighbour[j] = search_.neighbours()(triangle, column);
  }
  return element;
}

// The least height of the node over the other side of a triangle around it.
double GrowingElements::reach_m(std::int32_t node) const {
  double least = std::numeric_limits<double>::infinity();
  const auto i = static_cast<std::size_t>(node);
  for (std::int32_t k = around_begin_[i]; k < around_begin_[i + 1]; ++k) {
    const std::int32_t t = around_[static_cast<std::size_t>(k)];
    std::array<Eigen::Vector3d, 3> p;
    std::size_t here = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::int32_t corner = body_.triangle(t, static_cast<Eigen::Index>(j));
      p[j] = body_.position_m.row(corner).transpose();
      here = corner == node ? j : here;
    }
    const Eigen::Vector3d side = p[(here + 2) % 3] - p[(here + 1) % 3];
    const double height = side.cross(p[here] - p[(here + 1) % 3]).norm() / side.norm();
    least = std::min(least, height > 0.0 ? height : least);
  }
  return least;
}

bool GrowingElements::is_held(std::int32_t node) const {
  const auto i = static_cast<std::size_t>(node);
  const auto begin = around_.begin() + around_begin_[i];
  return std::any_of(begin, around_.begin() + around_begin_[i + 1],
                     [&](std::int32_t t) {
                       return held_mark_[static_cast<std::size_t>(t)] != 0;
                     });
}

// Whether this update sends every triangle of the node that may be held; adds those
// that are missing where there is room for them.
bool GrowingElements::sends_all_of(std::int32_t node, Sent& sent) const {
  Sent with = sent;
  const auto i = static_cast<std::size_t>(node);
  for (std::int32_t k = around_begin_[i]; k < around_begin_[i + 1]; ++k) {
    const std::int32_t t = around_[static_cast<std::size_t>(k)];
    if (held_mark_[static_cast<std::size_t>(t)] == 0 || with.has(t)) {
      continue;
    }
    if (with.count == with.triangle.size()) {
      return false;
    }
    with.triangle[with.count++] = t;
  }
  sent = with;
  return true;
}

void GrowingElements::arrive(Node& node) {
  const bool any = node.pending->to.samples > 0;
  node.now = any ? std::make_unique<ElementNode>(node.pending->to) : nullptr;
  node.rendered = node.pending->quality;
  node.pending = nullptr;
}

void GrowingElements::step(std::int32_t node, double share) {
  Node& at = node_[static_cast<std::size_t>(node)];
  Pending& pending = *at.pending;
  if (pending.blend == nullptr) {
    pending.blend =
        std::make_unique<NodeBlend>(message(node), pending.to, reach_m(node));
    at.largest_n = pending.blend->largest_n();
  }
  const ElementNode& now = pending.blend->step(share * at.largest_n);
  if (pending.blend->arrived()) {
    arrive(at);
  } else if (at.now != nullptr) {
    *at.now = now;
  } else {
    at.now = std::make_unique<ElementNode>(now);
  }
}

// Whether the tool may be on a triangle of the node when this update arrives: on the
// one in use, on the nearest one, or on one that it reaches until then.
bool GrowingElements::is_felt(std::int32_t node, const Sent& sent,
                              const Whereabouts& tool) const {
  const auto i = static_cast<std::size_t>(node);
  const auto begin = around_.begin() + around_begin_[i];
  return std::any_of(
      begin, around_.begin() + around_begin_[i + 1], [&](std::int32_t t) {
        if (t == tool.in_use || t == sent.triangle[0]) {
          return true;
        }
        if (held_mark_[static_cast<std::size_t>(t)] == 0 && !sent.has(t)) {
          return false;
        }
        Eigen::Matrix3d corners;
        for (Eigen::Index j = 0; j < 3; ++j) {
          corners.row(j) = body_.position_m.row(body_.triangle(t, j));
        }
        return nearest_in_triangle(corners, tool.point_m).distance_m <= tool.reach_m;
      });
}

// What is pending and can be handed to the fast process as a whole. Within the element
// in use nothing changes but by its own nodes: others take what is new at once, and the
// tool that crosses an edge later meets a field that is continuous there.
void GrowingElements::exchange(Sent& sent, const Whereabouts& tool, double share) {
  std::vector<std::int32_t> later;
  std::stable_partition(pending_.begin(), pending_.end(), [&](std::int32_t node) {
    return is_felt(node, sent, tool);
  });
  for (const std::int32_t node : pending_) {
    Node& at = node_[static_cast<std::size_t>(node)];
    const bool held = is_held(node);
    if (held && !(share > 0.0 && sends_all_of(node, sent))) {
      later.push_back(node);
    } else if (held && is_felt(node, sent, tool)) {
      step(node, share);
      if (at.pending != nullptr) {
        later.push_back(node);
      }
    } else {
      at.largest_n = std::max(largest_normal_force_n(message(node)),
                              largest_normal_force_n(at.pending->to));
      arrive(at);
    }
  }
  pending_.swap(later);
}

void GrowingElements::hold(std::int32_t triangle) {
  const auto found = std::find(held_.begin(), held_.end(), triangle);
  if (found != held_.end()) {
    std::rotate(held_.begin(), found, found + 1);
    return;
  }
  held_.insert(held_.begin(), triangle);
  held_mark_[static_cast<std::size_t>(triangle)] = 1;
  if (held_.size() > kHeld) {
    held_mark_[static_cast<std::size_t>(held_.back())] = 0;
    held_.pop_back();
  }
}

std::size_t GrowingElements::update(const ToolState& tool, std::int64_t now_ns,
                                    ElementFifo& fifo) {
  if (!tool.position_m.allFinite()) {
    return 0;
  }
  const bool known = tool.triangle >= 0 && tool.triangle < body_.triangle.rows();
  const bool walk = tool.in_contact && known;
  const SurfacePoint at = walk ? search_.walk(tool.position_m, tool.triangle)
                               : search_.nearest(tool.position_m);
  if (at.triangle < 0) {
    return 0;
  }
  count(tool, at, now_ns);
  tell_hand(tool);
  take_in();
  const WantedTriangles wanted =
      wanted_triangles(search_, at.triangle, walk ? tool.triangle : -1);
  Sent sent{.triangle = wanted.triangle, .count = wanted.count};
  if (known && !sent.has(tool.triangle)) {
    const std::size_t last = sent.triangle.size() - 1;
    sent.count = std::min(sent.count, last);
    sent.triangle[sent.count++] = tool.triangle;
  }
  const double passed_s = sequence_ == 0 ? 0.0 : seconds_in(now_ns - last_ns_);
  const double share = kStepShare * std::clamp(passed_s / kStepS, 0.0, 1.0);
  constexpr double kNearM = 1e-3;  // where the fast process may see the contact point
  const double moved_m =
      sequence_ == 0 ? 0.0 : (tool.position_m - last_.position_m).norm();
  exchange(sent,
           {.point_m = at.position_m,
            .in_use = known ? tool.triangle : -1,
            .reach_m = kNearM + 2.0 * moved_m},
           whole_ ? share : 0.0);
  last_ = tool;
  last_ns_ = now_ns;
  std::size_t pushed = 0;
  for (std::size_t i = 0; i < sent.count; ++i) {
    Element message = element(sent.triangle[i]);
    message.sequence = ++sequence_;
    message.sent_ns = now_ns;
    message.active = i == 0;
    pushed += fifo.push(message) ? 1 : 0;
    hold(sent.triangle[i]);
  }
  whole_ = pushed == sent.count;
  return pushed;
}

void GrowingElements::count(const ToolState& tool, const SurfacePoint& at,
                            std::int64_t now_ns) {
  first_ns_ = sequence_ == 0 ? now_ns : first_ns_;
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    n +=
        at.area_coordinate(j) * normal_.row(body_.triangle(at.triangle, j)).transpose();
  }
  n.normalize();
  const double height_m = (tool.position_m - at.position_m).dot(n);
  GrownQuality poorest = GrownQuality::kFinal;
  for (Eigen::Index j = 0; j < 3; ++j) {
    poorest = std::min(poorest, quality(body_.triangle(at.triangle, j)));
  }
  here_.store(poorest);
  if (!(tool.in_contact || height_m < height_m_)) {
    return;
  }
  // A new run counts its ticks from 1.
  const bool again = tool.sequence < last_.sequence;
  const auto passed =
      static_cast<std::int64_t>(tool.sequence - (again ? 0 : last_.sequence));
  const auto second =
      static_cast<std::size_t>(std::max(0.0, seconds_in(now_ns - first_ns_)));
  if (by_second_.size() <= second) {
    by_second_.resize(second + 1, {});
  }
  const auto row = static_cast<std::size_t>(poorest);
  by_second_[second][row] += passed;
  ticks_[row].fetch_add(passed, std::memory_order_relaxed);
}

void GrowingElements::tell_hand(const ToolState& tool) {
  constexpr double kSmoothS = 0.05;  // over which the velocity is taken
  const double dt_s = seconds_in(tool.time_ns - last_.time_ns);
  if (last_.sequence > 0 && dt_s > 0.0) {
    const double part = std::min(1.0, dt_s / kSmoothS);
    velocity_m_per_s_ +=
        part * ((tool.position_m - last_.position_m) / dt_s - velocity_m_per_s_);
  }
  hand_.write({.tool = 0,
               .position_m = tool.position_m,
               .velocity_m_per_s = velocity_m_per_s_,
               .touches = tool.in_contact});
}

bool GrowingElements::fetch_hand(HandPlace& hand) noexcept {
  if (!hand_.fetch()) {
    return false;
  }
  hand = hand_.latest();
  return true;
}

QualityTicks GrowingElements::ticks() const noexcept {
  QualityTicks ticks{};
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i] = ticks_[i].load(std::memory_order_relaxed);
  }
  return ticks;
}

}  // namespace palpate
