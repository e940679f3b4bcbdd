#include "support/allocations.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace polyrecon::test {
namespace {

std::atomic<std::size_t> in_use{0}, peak{0};

// The sanitizers have allocators of their own, which are not replaced: there the two functions have no caller.
[[maybe_unused]] void* count(void* p) {
  if (!p) throw std::bad_alloc();
  const std::size_t now = in_use += malloc_usable_size(p);
  std::size_t most = peak;
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
  return p;
}

[[maybe_unused]] void discount(void* p) noexcept {
  in_use -= malloc_usable_size(p);  // 0 for a null pointer
  std::free(p);
}

}  // namespace

bool counts_allocations() {
  const PeakAllocation counted;
  ::operator delete(::operator new(1000));
  return counted.bytes() >= 1000;
}

PeakAllocation::PeakAllocation() : before_(in_use) { peak = before_; }
std::size_t PeakAllocation::bytes() const { return peak - before_; }

}  // namespace polyrecon::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
using polyrecon::test::count;
using polyrecon::test::discount;

void* operator new(std::size_t size) { return count(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return count(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* p) noexcept { discount(p); }
void operator delete(void* p, std::size_t) noexcept { discount(p); }
void operator delete(void* p, std::align_val_t) noexcept { discount(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { discount(p); }
#endif
