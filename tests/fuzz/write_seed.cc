// Writes a small database as the seed of database_fuzz.
#include "formats/hdf5/hdf5_io.h"
#include "tests/support/small_database.h"

int main(int, char** argv) {
  palpate::skip_hdf5_exit_cleanup();
  palpate::write_database(argv[1], palpate::small_database());
  return 0;
}
