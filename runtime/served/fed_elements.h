// A body that is fed by a service's client as long as it lives.
#pragma once

#include "formats/database/response_database.h"
#include "runtime/served/growing_elements.h"
#include "runtime/served/served_client.h"

namespace palpate {

class FedElements : public ElementSender {
 public:
  /// Client and body, with one tool, must outlive it; the client has its scene.
  FedElements(ServedClient& client, const ResponseDatabase& body,
              double stiffness_max_n_per_m)
      : elements_(body.body, body.normal, body.tools.front().tool,
                  stiffness_max_n_per_m),
        feeding_(client, elements_) {}

  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override {
    return elements_.update(tool, now_ns, fifo);
  }

  [[nodiscard]] const GrowingElements& elements() const noexcept { return elements_; }

 private:
  GrowingElements elements_;
  Feeding feeding_;  // ends first
};

}  // namespace palpate
