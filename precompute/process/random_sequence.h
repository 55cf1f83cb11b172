// The C library's one sequence of random numbers, which METIS draws from.
#pragma once

#include <mutex>

namespace palpate {

/// Held by whoever draws from rand() or random(): two orderings at a time would share
/// the sequence out between them by chance. And while a child is forked: a child that
/// is forked while another thread draws finds the library's own lock taken for ever.
[[nodiscard]] std::mutex& random_sequence_mutex();

}  // namespace palpate
