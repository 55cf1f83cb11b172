#include "precompute/process/random_sequence.h"

namespace palpate {

std::mutex& random_sequence_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace palpate
