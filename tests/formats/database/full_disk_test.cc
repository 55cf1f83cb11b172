// What a tool does where nothing can be written, or what it reads was cut short: one
// line that says what and where, and all that was there is still there.
//
// The full and the read-only disk are small ones in memory, mounted for this process
// alone; skipped where that is not allowed.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sched.h>
#include <sys/mount.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/response_database.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/run_tool.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), {}));
}

// Disks that only this process and its children see.
bool own_mounts() {
  static const bool mine =
      ::unshare(CLONE_NEWNS) == 0 &&
      ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  return mine;
}

class SmallDisk {
 public:
  explicit SmallDisk(const std::string& size)
      : mounted_(own_mounts() && ::mount("tmpfs", folder_.path().c_str(), "tmpfs", 0,
                                         ("size=" + size).c_str()) == 0) {}
  ~SmallDisk() {
    if (mounted_) {
      ::umount2(folder_.path().c_str(), MNT_DETACH);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  [[nodiscard]] bool mounted() const { return mounted_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return folder_ / name;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] bool make_read_only() const {
    return ::mount("tmpfs", path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) ==
           0;
  }

 private:
  ScratchFolder folder_;
  bool mounted_;
};

// Commands that each want to write `target` from databases of the same body.
std::vector<std::vector<std::string>> writers(const std::string& source,
                                              const std::string& other,
                                              const std::filesystem::path& folder) {
  return {{"slice", source, "-o", folder / "a.h5"},
          {"merge", source, other, "-o", folder / "a.h5"},
          {"export", source, "-o", folder / "a.vtu"},
          {"export", source, "-o", folder / "a.csv"},
          {"export", source, "-o", folder / "a.json"},
          {"picture", source, "-o", folder / "a.svg"},
          {"report", source, "-o", folder / "a.html"}};
}

void expect_one_line(const ToolRun& run, int exit_code, const std::string& why,
                     const std::string& where) {
  EXPECT_EQ(run.exit_code, exit_code) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find(why), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(where), std::string::npos) << run.err;
}

class Sources {
 public:
  Sources() {
    ResponseDatabase database = sphere_database(12, 17);
    write_database(file, database);
    database.tools.front().tool.name = "other";
    write_database(other, database);
  }
  const ScratchFolder folder;
  const std::string file = folder / "source.h5";
  const std::string other = folder / "other.h5";
};

TEST(FullDisk, IsSaidInOneLineAndLosesNothing) {
  const SmallDisk disk("64k");  // holds the small database, nothing of the sources'
  if (!disk.mounted()) {
    GTEST_SKIP() << "mounting is not allowed here";
  }
  const Sources source;
  write_database(disk / "a.h5", small_database());
  const std::string filling(
      static_cast<std::size_t>(std::filesystem::space(disk.path()).available), 'x');
  std::ofstream(disk / "filling", std::ios::binary) << filling;
  const std::string before = bytes_of(disk / "a.h5");
  for (const auto& arguments : writers(source.file, source.other, disk.path())) {
    SCOPED_TRACE(arguments.front() + " " + arguments.back());
    expect_one_line(run_tool_process("palpate-db", arguments), 75,
                    "No space left on device", arguments.back());
    EXPECT_EQ(files_in(disk.path()), 2u);
    EXPECT_EQ(bytes_of(disk / "a.h5"), before);
  }
  EXPECT_EQ(run_tool_process("palpate-db", {"check", disk / "a.h5"}).exit_code, 0);
}

TEST(ReadOnlyDisk, CanBeReadFromAndIsNamedByWhatWantsToWrite) {
  const SmallDisk disk("4m");
  if (!disk.mounted()) {
    GTEST_SKIP() << "mounting is not allowed here";
  }
  const Sources source;
  write_database(disk / "a.h5", small_database());
  ASSERT_TRUE(disk.make_read_only());
  for (const auto& arguments : writers(source.file, source.other, disk.path())) {
    SCOPED_TRACE(arguments.front() + " " + arguments.back());
    expect_one_line(run_tool_process("palpate-db", arguments), 2,
                    "Read-only file system", arguments.back());
  }
  EXPECT_EQ(run_tool_process("palpate-db", {"check", disk / "a.h5"}).exit_code, 0);
  EXPECT_EQ(run_tool_process("palpate-db", {"info", disk / "a.h5"}).exit_code, 0);
}

// Where the raw bytes of every dataset begin and end.
std::vector<std::size_t> section_ends(const std::filesystem::path& file) {
  std::vector<std::size_t> ends;
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  H5Ovisit2(
      id, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t object, const char* name, const H5O_info_t* info, void* to) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) {
          const hid_t dataset = H5Dopen2(object, name, H5P_DEFAULT);
          const haddr_t at = H5Dget_offset(dataset);
          if (at != HADDR_UNDEF) {
            auto& all = *static_cast<std::vector<std::size_t>*>(to);
            all.insert(all.end(), {at, at + H5Dget_storage_size(dataset)});
          }
          H5Dclose(dataset);
        }
        return 0;
      },
      &ends, H5O_INFO_BASIC);
  H5Fclose(id);
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

TEST(CutFile, IsRefusedWhereverASectionBeginsOrEnds) {
  const Sources source;
  const std::string whole = bytes_of(source.file);
  const std::vector<std::size_t> ends = section_ends(source.file);
  ASSERT_GT(ends.size(), 30u);
  const std::filesystem::path cut = source.folder / "cut.h5";
  int refused = 0;
  for (const std::size_t end : ends) {
    for (const std::size_t length : {end - 1, end, end + 1}) {
      if (length >= whole.size()) {
        continue;
      }
      std::ofstream(cut, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
      EXPECT_THROW((void)read_database(cut), FormatError) << length;
      EXPECT_THROW((void)read_index(cut), FormatError) << length;
      ++refused;
    }
  }
  std::printf("%d cuts at the ends of %zu sections refused\n", refused, ends.size());
}

TEST(CutFile, IsNamedByEveryToolThatReadsItAndNothingIsWritten) {
  const Sources source;
  const std::filesystem::path target = source.folder / "target.h5";
  write_database(target, small_database());
  const std::string before = bytes_of(target);
  std::filesystem::resize_file(source.file,
                               std::filesystem::file_size(source.file) / 2);
  const std::size_t files = files_in(source.folder.path());
  std::vector<std::vector<std::string>> commands =
      writers(source.file, source.other, source.folder.path());
  commands.insert(commands.end(), {{"slice", source.file, "-o", target},
                                   {"check", source.file},
                                   {"info", source.file},
                                   {"diff", source.other, source.file},
                                   {"bench", "precision", source.file}});
  for (const auto& arguments : commands) {
    SCOPED_TRACE(arguments.front());
    expect_one_line(run_tool_process("palpate-db", arguments), 3,
                    "truncated or damaged", source.file);
  }
  EXPECT_EQ(files_in(source.folder.path()), files);
  EXPECT_EQ(bytes_of(target), before);
}

}  // namespace
}  // namespace palpate
