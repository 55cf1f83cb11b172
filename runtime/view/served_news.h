// What is reported to pages of a body whose responses come while they look at it:
// answers in batches, and how the service is.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "runtime/served/growing_elements.h"
#include "runtime/served/scene_watch.h"
#include "runtime/served/served_client.h"
#include "runtime/view/view_news.h"

namespace palpate {

/// One thread, the server's.
class ServedNews : public ViewNews {
 public:
  static constexpr std::int64_t kBatchNs = 100'000'000;  ///< between two of one page
  static constexpr std::size_t kBatch = 4000;            ///< nodes of one, at most

  /// Client and elements must outlive it; the client has its scene.
  ServedNews(ServedClient& client, const GrowingElements& elements,
             const ServedScene& scene, SceneWatch watch);

  /// How the service is, for a frame.
  [[nodiscard]] ViewService service() override;

  /// The next answers that have not been reported to the page, if it is time for them:
  ///
  ///   {"type": "answers", "node": [..], "stiffness": [..], "final": [0 or 1, ..],
  ///    "low_n_per_m": .., "high_n_per_m": .., "force_max_n": ..}
  ///
  /// stiffness [N/m] is as the map's (surface_map.h), null for an answer of no
  /// response. The range, and the largest force, are those of all answers so far.
  [[nodiscard]] std::optional<std::string> answers(ViewClient page,
                                                   std::int64_t now_ns) override;
  void forget(ViewClient page) override { page_.erase(page); }

  /// As curve_text(), of a node's answer so far. @throws InputError for a node that is
  /// not there.
  [[nodiscard]] std::string curve(std::int32_t node) const override;

  void start_anew() override { client_.start_anew(); }

 private:
  struct Page {
    std::size_t changes = 0;
    std::vector<std::int32_t> waiting = {};  // nodes, the last one first
    std::int64_t sent_ns = -kBatchNs;
  };

  [[nodiscard]] double stiffness_n_per_m(std::int32_t node) const;
  void measure();

  ServedClient& client_;
  const GrowingElements& elements_;
  const ServedScene& scene_;
  SceneWatch watch_;
  double map_depth_m_;
  std::map<ViewClient, Page> page_;
  std::size_t measured_ = 0;       // changes
  std::vector<double> stiffness_;  // (n) NaN: none
  double low_n_per_m_ = 0.0;
  double high_n_per_m_ = 1.0;
  double force_max_n_ = 0.0;
};

}  // namespace palpate
