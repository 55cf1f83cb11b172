// Whether a body's factor fits into this machine, said before it is made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

/// Where the system says what memory there is: proc(5), and the tree of control groups.
struct MemoryFiles {
  std::filesystem::path proc = "/proc";
  std::filesystem::path groups = "/sys/fs/cgroup";
};

/// Memory that programs may still take without anything being swapped [bytes]. The
/// value is MemAvailable, or less where a control group has a limit (version 1 or 2).
/// Such a group is one that this process is in, or one around it. What is used of a
/// limit does not count pages of files that nobody has read twice: these are dropped
/// first. The largest number where nothing is said.
[[nodiscard]] std::int64_t free_memory_bytes(const MemoryFiles& files = {});

/// What this process could have if nothing else took any [bytes].
[[nodiscard]] std::int64_t most_memory_bytes(const MemoryFiles& files = {});

/// @param what "the factor of 12 unknowns", @param advice what a user can do whose
/// machine is too small. @param least_bytes at most `bytes`: of an estimate, what it
/// takes at least.
/// @throws InputError if the machine does not have them, ResourceError if they are not
/// free, nor become so within kMomentS.
void require_free_memory(double bytes, double least_bytes, const std::string& what,
                         const std::string& advice, const MemoryFiles& files = {});

/// Peak memory [bytes] of factorising a compact body in quadratic tets that grow
/// inwards from a surface of so many triangles. The value is rather too high, because
/// too low a value ends in a killed build. It is within 5 % for an organ of 5,120 and
/// 20,480 triangles. It is a third more than cylinders of 3,000 to 15,000 triangles
/// need (tests/bench/factor_study.cc). Thin bodies take less, bodies of equal tets
/// more.
[[nodiscard]] double expected_memory_bytes(std::int64_t triangles);

/// require_free_memory() of what a body of so many surface triangles is expected to
/// need, less what the expectation can be wrong by (1.4).
void require_memory(std::int64_t triangles);

}  // namespace palpate
