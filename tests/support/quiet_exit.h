// Included, the test program exits without HDF5's clean-up: for tests that open damaged
// files.
#pragma once

#include "formats/hdf5/hdf5_lock.h"

namespace palpate {

[[maybe_unused]] inline const bool kQuietExit = (skip_hdf5_exit_cleanup(), true);

}  // namespace palpate
