#include "formats/hdf5/hdf5_lock.h"

#include <hdf5.h>

namespace palpate {

std::recursive_mutex& hdf5_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

Hdf5Lock::Hdf5Lock() : guard_(hdf5_mutex()) {}

void lock_hdf5() {
  hdf5_mutex().lock();
}

void unlock_hdf5() {
  hdf5_mutex().unlock();
}

QuietHdf5::QuietHdf5() {
  H5E_auto2_t function = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &function, &data_);
  function_ = reinterpret_cast<void*>(function);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietHdf5::~QuietHdf5() {
  H5Eset_auto2(H5E_DEFAULT, reinterpret_cast<H5E_auto2_t>(function_), data_);
}

void skip_hdf5_exit_cleanup() noexcept {
  H5dont_atexit();
}

}  // namespace palpate
