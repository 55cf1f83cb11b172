// Loops on several threads that end whole or by an exception.
#pragma once

#include <cstddef>
#include <functional>

namespace palpate {

/// `wanted`, or for 0 as many as there are processors. At least 1.
[[nodiscard]] unsigned thread_count(unsigned wanted) noexcept;

/// Calls body(0) ... body(count - 1), in no order, on as many threads as thread_count()
/// says, the caller's among them. Returns once all are done. After an exception no
/// further call begins; the first exception is thrown once those under way have ended.
void on_threads(unsigned wanted, std::size_t count,
                const std::function<void(std::size_t)>& body);

}  // namespace palpate
