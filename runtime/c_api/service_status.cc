#include "runtime/c_api/service_status.h"

#include <cstdint>

namespace palpate {

palpate_service service_status(const HostBody& body) {
  palpate_service all{};
  const ServedClient* client = body.service();
  if (client == nullptr) {
    return all;
  }
  const ServiceStatus status = client->status();
  all.state = 1 + static_cast<std::int32_t>(status.state);
  all.started = status.started ? 1 : 0;
  all.nodes = status.progress.nodes;
  all.answered = status.progress.answered;
  all.finished = status.progress.finished;
  all.softened = body.softened();
  status.detail.copy(all.detail, sizeof all.detail - 1);  // the rest is zero
  return all;
}

}  // namespace palpate
