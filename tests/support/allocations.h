#pragma once

#include <cstddef>

namespace polyrecon::test {

/// Whether allocations are counted: not where a sanitizer or valgrind puts its own operator new in place of ours.
bool counts_allocations();

/// The most bytes from operator new that were in use at once since the object was made, less those in use then. One
/// object at a time.
class PeakAllocation {
 public:
  PeakAllocation();
  std::size_t bytes() const;

 private:
  std::size_t before_;
};

}  // namespace polyrecon::test
