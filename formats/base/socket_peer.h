// Who is at the other end of a local socket.
#pragma once

#include <cstdint>
#include <optional>

namespace palpate {

/// The user at the other end (SO_PEERCRED) where it is neither this process' user nor
/// root; -1 where nobody says. None: it is.
[[nodiscard]] std::optional<std::uint32_t> stranger_at(int descriptor) noexcept;

}  // namespace palpate
