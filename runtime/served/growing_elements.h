// The slow process of a body whose responses come while it is rendered. A node that the
// tool is not on takes a new response at once. All elements that the fast process may
// hold of that node take it. Nobody feels the change. A response of the element in use,
// or of one that the tool may reach meanwhile, goes there in steps (node_blend.h). In
// 10 ms the force changes by at most kStepShare of the larger of both responses'
// largest force. From nothing the force rises by the same steps. The ledger books each
// as any change of an element. What rises under a tool at rest would cost energy that
// nobody has put in. The ledger holds the surface back until the tool lifts (relaxed
// shift). The next press feels all of it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "formats/mesh/surface_search.h"
#include "formats/response/tool_shape.h"
#include "formats/service/service_message.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/served/grown_node.h"
#include "runtime/served/node_blend.h"
#include "runtime/slow/element_message.h"
#include "runtime/slow/element_source.h"

namespace palpate {

/// Fast ticks with the tool in the body, by what the place answers with. That is the
/// poorest of its triangle's nodes, as it was rendered until then. A response on its
/// way counts as the old one until the new one has arrived.
using QualityTicks = std::array<std::int64_t, kGrownQualities>;

class GrowingElements : public ElementSender {
 public:
  static constexpr double kStepShare = 0.05;  ///< [-] of a node's largest force ...
  static constexpr double kStepS = 0.01;      ///< [s] ... in this time, and at once
  /// Answers that one update looks at besides those that the tool may feel: the end of
  /// a large scene tells all of them at once.
  static constexpr std::size_t kAnUpdate = 1024;

  /// Body and normals must outlive it. @param stiffness_max_n_per_m [N/m] > 0 what is
  /// steeper is softened (soften()), and counted.
  GrowingElements(const SurfaceMesh& body, const Points& normal, const ToolShape& tool,
                  double stiffness_max_n_per_m = kAnyStiffness);
  static constexpr double kAnyStiffness = std::numeric_limits<double>::infinity();

  /// The same, before anything is handed over.
  void soften_beyond(double stiffness_max_n_per_m) noexcept {
    stiffness_max_n_per_m_ = stiffness_max_n_per_m;
  }

  /// Any thread: answers for the body, from the next update on; never waits for one. An
  /// answer replaces those of the same node of the same or lower quality. Nodes that
  /// the body does not have are passed over.
  void hand_over(std::vector<GrownNode> answers);

  /// Any thread: what is known now was for another scene. It is rendered until answers
  /// come, whatever their quality, and counts as preliminary.
  void outdate() noexcept { outdated_.store(true); }

  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override;

  [[nodiscard]] const SurfaceSearch& search() const noexcept { return search_; }

  /// One other thread: where the tool is, if that is news; tool index 0.
  [[nodiscard]] bool fetch_hand(HandPlace& hand) noexcept;

  /// Any thread.
  [[nodiscard]] QualityTicks ticks() const noexcept;
  [[nodiscard]] std::int64_t softened() const noexcept { return softened_.load(); }
  /// [N/m] of the stiffest answer so far.
  [[nodiscard]] double stiffest_n_per_m() const noexcept { return stiffest_.load(); }
  [[nodiscard]] GrownQuality here() const noexcept { return here_.load(); }

  // The slow thread, or after it has ended.

  /// Ticks in the body in every second since the first update.
  [[nodiscard]] const std::vector<QualityTicks>& by_second() const noexcept {
    return by_second_;
  }
  [[nodiscard]] GrownQuality quality(std::int32_t node) const {
    return node_[static_cast<std::size_t>(node)].rendered;
  }
  /// [N] by which kStepShare is multiplied, of the node's latest exchange.
  [[nodiscard]] double largest_n(std::int32_t node) const {
    return node_[static_cast<std::size_t>(node)].largest_n;
  }
  [[nodiscard]] std::int64_t waiting() const noexcept {
    return static_cast<std::int64_t>(pending_.size() + taken_.size() - next_taken_);
  }

 private:
  struct Pending {
    GrownQuality quality = GrownQuality::kNone;
    ElementNode to;
    std::unique_ptr<NodeBlend> blend;  // once it is on its way
  };
  struct Node {
    std::unique_ptr<ElementNode> now;  // null: no response
    std::unique_ptr<Pending> pending;
    GrownQuality rendered = GrownQuality::kNone;
    GrownQuality known = GrownQuality::kNone;
    double largest_n = 0.0;
  };
  struct Sent {
    std::array<std::int32_t, 1 + kNeighboursMax> triangle{};
    std::size_t count = 0;
    [[nodiscard]] bool has(std::int32_t t) const noexcept;
  };

  void take_in();
  void take_in(const GrownNode& answer);
  [[nodiscard]] ElementNode message(std::int32_t node) const;
  [[nodiscard]] Element element(std::int32_t triangle) const;
  [[nodiscard]] double reach_m(std::int32_t node) const;
  [[nodiscard]] bool is_held(std::int32_t node) const;
  [[nodiscard]] bool sends_all_of(std::int32_t node, Sent& sent) const;
  // Where the tool is when an update arrives.
  struct Whereabouts {
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // of the surface
    std::int32_t in_use = -1;                           // triangle
    double reach_m = 0.0;
  };
  [[nodiscard]] bool is_felt(std::int32_t node, const Sent& sent,
                             const Whereabouts& tool) const;
  void exchange(Sent& sent, const Whereabouts& tool, double share);
  void arrive(Node& node);
  void step(std::int32_t node, double share);
  void hold(std::int32_t triangle);
  void count(const ToolState& tool, const SurfacePoint& at, std::int64_t now_ns);
  void tell_hand(const ToolState& tool);

  const SurfaceMesh& body_;
  const Points& normal_;
  ToolShape tool_;
  double stiffness_max_n_per_m_;
  double height_m_;  // of the reference point at touch
  SurfaceSearch search_;
  std::vector<std::int32_t> around_begin_;  // (n + 1) into around_
  std::vector<std::int32_t> around_;        // triangles around each node
  std::vector<Node> node_;
  std::vector<std::int32_t> pending_;    // nodes
  std::vector<std::int32_t> held_;       // triangles, the latest sent first
  std::vector<std::uint8_t> held_mark_;  // (t)
  std::vector<GrownNode> taken_;         // of waiting_, from next_taken_ not looked at
  std::size_t next_taken_ = 0;
  std::uint64_t sequence_ = 0;
  bool whole_ = true;  // all of the last update fitted the queue
  ToolState last_;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  Eigen::Vector3d velocity_m_per_s_ = Eigen::Vector3d::Zero();
  std::vector<QualityTicks> by_second_;

  std::mutex mutex_;  // of waiting_; an update only tries it
  std::vector<GrownNode> waiting_;
  std::atomic<bool> outdated_ = false;
  TripleBuffer<HandPlace> hand_;
  std::array<std::atomic<std::int64_t>, kGrownQualities> ticks_{};
  std::atomic<std::int64_t> softened_ = 0;
  std::atomic<double> stiffest_ = 0.0;
  std::atomic<GrownQuality> here_ = GrownQuality::kNone;
};

}  // namespace palpate
