#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/socket_peer.h"

namespace palpate {

std::optional<std::uint32_t> stranger_at(int descriptor) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return static_cast<std::uint32_t>(-1);
  }
  return peer.uid == ::geteuid() || peer.uid == 0 ? std::nullopt
                                                  : std::optional(peer.uid);
}

}  // namespace palpate
