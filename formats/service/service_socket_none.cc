// Where palpate-precompute does not run, no service of a scene listens.
#include "formats/base/error.h"
#include "formats/service/service_socket.h"

namespace palpate {

ServiceConnection::~ServiceConnection() = default;
ServiceConnection::ServiceConnection(ServiceConnection&& other) noexcept = default;
ServiceConnection& ServiceConnection::operator=(ServiceConnection&& other) noexcept =
    default;
void ServiceConnection::close() noexcept {}

std::optional<ServiceConnection> ServiceConnection::join(
    const std::filesystem::path& /*socket*/) {
  throw InputError(
      "scenes are not rendered while they are computed by this build of palpate: give "
      "the database that palpate-precompute made of the scene");
}

bool ServiceConnection::send(std::span<const std::byte> /*frame*/,
                             std::chrono::milliseconds /*within*/) {
  return false;
}

bool ServiceConnection::send(const ServiceMessage& /*message*/,
                             std::chrono::milliseconds /*within*/) {
  return false;
}

std::optional<ServiceMessage> ServiceConnection::receive(
    std::chrono::milliseconds /*within*/) {
  return std::nullopt;
}

}  // namespace palpate
